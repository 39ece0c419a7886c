//! `fsct dossier` as a user runs it: from records that fsct has just made, and from what is no record.

mod cli;

use cli::{Folder, fsct};
use fsct_adapters::Role;
use fsct_harness::gauntlet::matrix;
use fsct_harness::library::Library;
use fsct_reports::dossier::CHAPTERS;
use fsct_reports::gauntlet::Gauntlet;
use rstest::rstest;

const DEVICE: &str = "inproc:reference-device";

fn library() -> Library {
    Library::embedded().unwrap_or_else(|problems| panic!("{}", problems[0].render(false)))
}

/// Records a run of this suite.
fn run(folder: &Folder, args: &[&str]) -> i32 {
    fsct(&[&["run"], args, &["--out", &folder.out()]].concat()).code
}

/// The page made of these records.
fn page(folder: &Folder, args: &[&str]) -> String {
    let out = folder.0.join("dossier.html").display().to_string();
    let made = fsct(&[&["dossier"], args, &["--out", &out]].concat());
    assert_eq!(made.code, 0, "{made:?}");
    folder.text("dossier.html")
}

/// Exit code 2 and one sentence.
fn refused(args: &[&str]) -> String {
    let made = fsct(&[&["dossier", "--out", "never-made.html"], args].concat());
    assert_eq!((made.code, made.err.lines().count()), (2, 1), "{made:?}");
    assert!(!std::path::Path::new("never-made.html").exists());
    made.err
}

/// A folder with a record of every kind about the reference FS-Device.
fn everything() -> Folder {
    let folder = Folder::new("dossier-everything");
    assert_eq!(run(&folder, &["device-counter", "error-matrix", "--edition", "iec2022", "--dut", DEVICE]), 0);
    for (name, args) in [
        ("random", &["random", "--exchanges", "3000", "--faults", "400"][..]),
        ("bits", &["bits", "--flips", "1", "--length", "4"]),
        ("record", &["record", "--flips", "1", "--edition", "iec2022", "--mode", "crc16"]),
        ("noise", &["noise", "--ber", "0.5", "--length", "4", "--spdus", "150000"]),
    ] {
        let out = folder.0.join(name).display().to_string();
        assert_eq!(fsct(&[&["campaign"], args, &["--dut", DEVICE, "--out", &out]].concat()).code, 0);
    }
    folder.file(
        "prove.json",
        &fsct(&["prove", "--watchdog", "2", "--property", "P1", "--property", "P3-master", "--json"]).out,
    );
    folder.file("residual.json", &fsct(&["crc", "--residual", "--mode", "crc16", "--octets", "6..7", "--json"]).out);
    let mut library = library();
    library.suites.iter_mut().for_each(|suite| suite.cases.retain(|case| case.id == "FSD-0202"));
    let matrix = matrix(&library, Role::Device, &|| ()).unwrap_or_else(|problem| panic!("{}", problem.render(false)));
    Gauntlet::new(vec![matrix], 0.0).write(&folder.0).expect("it can be written");
    folder
}

#[test]
fn records_of_every_kind_fill_every_chapter() {
    let folder = everything();
    let at = |name: &str| folder.0.join(name).display().to_string();
    let records = [folder.out(), at("random"), at("bits"), at("record"), at("noise")];
    let records: Vec<&str> = records.iter().map(String::as_str).collect();
    let html = page(&folder, &[&records[..], &["--date", "a day in May"]].concat());
    for text in [
        "fsct reference FS-Device 0.1.0",
        "It is no certificate",
        "a day in May",
        "12 of 12 transitions taken",
        "P3-master",
        "faults had to be detected, and were",
        "corruptions had to be detected, none was undetected",
        "falsified records, none started it",
        "Every SPDU was judged by its signature",
        "polynomial 0x4EAB",
        "counter-check-missing",
        "FSP_Watchdog</th><td>20 ms",
        "FSD-0202",
        "354 of 354 known answers",
    ] {
        assert!(html.contains(text), "no {text:?}");
    }
    // Each file is named by its hash.
    assert_eq!(html.matches("<code class=\"hash\">").count(), 8);
    assert_eq!(html.matches("Not in these records: ").count(), 0, "every kind of record is there");
    // Nothing is loaded, runs, or has to be opened first.
    for word in ["<script", "http://", "https://", "<link", "url(", "<details"] {
        assert!(!html.contains(word), "{word}");
    }
    assert_eq!(html, page(&folder, &[&records[..], &["--date", "a day in May"]].concat()), "the same octets again");
}

/// What a concept approval rests on, each item in the chapter that answers it.
#[test]
fn every_item_of_annex_i_has_its_chapter() {
    let folder = Folder::new("dossier-annex");
    assert_eq!(run(&folder, &["device-counter", "--dut", DEVICE]), 0);
    let html = page(&folder, &[&folder.out()]);
    let library = library();
    let items = library.annex_i.as_ref().expect("it is carried").evidence(&library.ledger, |_| Vec::new()).items;
    let mut places: Vec<usize> = Vec::new();
    for item in items.iter().filter(|item| item.clause == "I.4") {
        let begin =
            html.find(&format!("id=\"{}\"", item.chapter)).unwrap_or_else(|| panic!("no chapter {}", item.chapter));
        let end = html[begin..].find("</section>").expect("it ends") + begin;
        assert!(html[begin..end].contains(&item.asks), "{} is not in {}", item.asks, item.chapter);
        places.push(begin);
    }
    assert_eq!(places.len(), 8);
    assert!(places.is_sorted(), "the chapters follow the annex");
    for chapter in CHAPTERS {
        assert!(html.contains(&format!("<a href=\"#{}\">", chapter.key)), "the contents lack {}", chapter.key);
    }
}

#[test]
fn what_no_record_shows_is_a_gap_with_its_command() {
    let folder = Folder::new("dossier-gaps");
    assert_eq!(run(&folder, &["device-counter", "--edition", "iec2022", "--dut", DEVICE]), 0);
    let html = page(&folder, &[&folder.out()]);
    let gaps = html.split("id=\"gaps\"").nth(1).and_then(|rest| rest.split("</section>").next()).expect("a chapter");
    for command in [
        "fsct gauntlet --out DIR",
        "fsct campaign random --dut URL --out DIR",
        "fsct campaign bits --dut URL --out DIR",
        "fsct campaign record --dut URL --out DIR",
        "fsct prove --json &gt; DIR/prove.json",
        "fsct crc --residual --json &gt; DIR/residual.json",
        "fsct run error-matrix --dut URL --out DIR",
        "fsct run --edition v1.1 --dut URL --out DIR",
    ] {
        assert!(gaps.contains(command), "no {command}");
    }
    for text in
        ["Statements that need instruments", "open in the ledger", "no hardware", "that are not in these records"]
    {
        assert!(gaps.contains(text), "no {text:?}");
    }
}

#[test]
fn a_failure_is_printed_and_judged_nowhere_else() {
    let folder = Folder::new("dossier-fails");
    let dut = "inproc:reference-device?mutant=counter-check-missing";
    assert_eq!(run(&folder, &["device-counter", "--dut", dut]), 1);
    let html = page(&folder, &[&folder.out()]);
    assert!(html.contains("✗ Not conformant") && html.contains("✗ failed"));
    let gaps = html.split("id=\"gaps\"").nth(1).expect("a chapter");
    assert!(gaps.contains("✗ Failures") && gaps.contains("FSD-0202") && gaps.contains("mutant=counter-check-missing"));
}

#[test]
fn one_dossier_is_about_one_product() {
    let both = Folder::new("dossier-both");
    assert_eq!(
        run(&both, &["device-counter", "master-errors", "--dut", DEVICE, "--dut", "inproc:reference-master"]),
        0
    );
    let said = refused(&[&both.out()]);
    assert!(
        said.contains("reference FS-Device") && said.contains("reference FS-Master") && said.contains("--role"),
        "{said}"
    );
    let html = page(&both, &[&both.out(), "--role", "master"]);
    assert!(html.contains("<h1>fsct reference FS-Master") && html.contains("Records about others"));
    assert!(html.contains("FSM-0") && !html.contains("FSD-0202"), "cases of the other side are not in it");
    // Another product of the same role.
    let other = Folder::new("dossier-other");
    let out = other.out();
    assert_eq!(fsct(&["campaign", "random", "--exchanges", "2000", "--faults", "200", "--out", &out]).code, 0);
    other.file("campaign.json", &other.text("campaign.json").replace("reference FS-Device", "Curtain 3000"));
    let said = refused(&[&both.out(), &out, "--role", "device"]);
    assert!(said.contains("Curtain 3000") && said.contains("give the records of one"), "{said}");
}

#[test]
fn a_run_that_was_cut_off_is_printed_as_such() {
    let folder = Folder::new("dossier-cut");
    assert_eq!(run(&folder, &["device-counter", "--dut", DEVICE]), 0);
    let text = folder.text("run.jsonl");
    folder.file("run.jsonl", &text[..text.len() - 200]);
    let html = page(&folder, &[&folder.out()]);
    assert!(html.contains("Record [1] is not whole: line "), "it says why");
}

#[rstest]
#[case::nothing_there("no/such/folder", "", "no/such/folder")]
#[case::an_empty_folder("", "", "holds no record (run.jsonl, campaign.json")]
#[case::no_journal("run.jsonl", "{}\n", "run.jsonl:1")]
#[case::half_a_document(
    "gauntlet.json",
    "{\"schema\": \"fsct-gauntlet/1\", \"roles\": [",
    "make it again with `fsct gauntlet --out DIR`"
)]
#[case::an_older_document(
    "campaign.json",
    "{\"schema\": \"fsct-campaign-bits/1\"}",
    "no record of the schema `fsct-campaign-bits/1`"
)]
#[case::a_field_is_missing("campaign.json", "{\"schema\": \"fsct-campaign-bits/2\", \"fsct\": \"0\"}", "missing field")]
#[case::no_document("residual.json", "[1, 2]", "states no schema")]
#[case::an_empty_list("prove.json", "[]", "states no schema")]
fn what_is_no_record_is_refused_in_one_sentence(#[case] name: &str, #[case] text: &str, #[case] said: &str) {
    let folder = Folder::new(&format!("dossier-bad-{}-{}", name.replace('/', "-"), text.len()));
    let place = match (name, text) {
        ("", _) => folder.out(),
        (name, "") => name.to_owned(),
        (name, text) => folder.file(name, text),
    };
    let sentence = refused(&[&place]);
    assert!(sentence.contains(said), "{sentence}");
}

#[test]
fn without_a_run_there_is_no_product() {
    let folder = Folder::new("dossier-no-run");
    let proof = folder.file("prove.json", &fsct(&["prove", "--watchdog", "2", "--property", "P1", "--json"]).out);
    let said = refused(&[&proof]);
    assert!(said.contains("begins with `fsct run --dut URL --out DIR`"), "{said}");
}

#[test]
fn a_dut_that_was_not_reached_is_no_product() {
    let folder = Folder::new("dossier-dead");
    assert_eq!(run(&folder, &["--filter", "FSD-0001", "--dut", "tcp://127.0.0.1:1"]), 3);
    let said = refused(&[&folder.out()]);
    assert!(said.contains("was reached"), "{said}");
}
