//! The dossier of a small record: its outline, hostile text, and two DUTs of one product.

use crate::common::*;
use fsct_reports::Run;
use fsct_reports::dossier::{CHAPTERS, Dossier, KnownCase, Reading, SelfTest, Statement, Tool, read, render};
use fsct_reports::record::*;
use insta::assert_snapshot;
use std::collections::BTreeMap;

fn statement(id: &str, class: &str, dut: &str) -> Statement {
    Statement {
        id: id.into(),
        clauses: BTreeMap::from([("iec2022".into(), "11.5".into())]),
        dut: dut.into(),
        level: "shall".into(),
        class: class.into(),
        text: format!("What {id} says"),
        why: if class == "open" { "no case yet".into() } else { String::new() },
    }
}

/// A tool with a statement of every class, and an item of Annex I for every chapter.
fn tool() -> Tool {
    let known = |id: &str, role: &str, judges: &str| KnownCase {
        id: id.into(),
        suite: "device-startup".into(),
        role: role.into(),
        requirements: vec![judges.into()],
    };
    let item = |chapter: &str| EvidenceItem {
        chapter: chapter.into(),
        clause: "I.4".into(),
        asks: format!("Something about {chapter}"),
        ..EvidenceItem::default()
    };
    Tool {
        version: "0.0.0".into(),
        statements: vec![
            statement("R-11.5.4.1-01", "tested", "device"),
            statement("R-1-RUN", "tested", "device"),
            statement("R-1-OTHER", "tested", "both"),
            statement("R-1-ORACLE", "implicit", "device"),
            statement("R-1-IODD", "implicit", "iodd"),
            statement("R-1-BENCH", "bench", "device"),
            statement("R-1-READ", "inspection", "both"),
            statement("R-1-OPEN", "open", "device"),
            statement("R-1-MASTER", "tested", "master"),
        ],
        cases: vec![
            known("FSD-0001", "device", "R-11.5.4.1-01"),
            known("FSD-0900", "device", "R-1-RUN"),
            known("FSM-0001", "master", "R-1-OTHER"),
        ],
        readings: BTreeMap::from([(
            "A19".into(),
            Reading {
                name: "T29 read sequentially".into(),
                stance: "tolerated".into(),
                text: "Default: nested.".into(),
            },
        )]),
        items: CHAPTERS.iter().map(|chapter| item(chapter.key)).collect(),
        members: BTreeMap::new(),
        self_test: vec![SelfTest {
            what: "Answers".into(),
            outcome: "all".into(),
            passed: true,
            command: "fsct vectors".into(),
        }],
    }
}

fn page(name: &str, run: &Run) -> String {
    let folder = Folder::with(name, run);
    let sources = read(std::slice::from_ref(&folder.0)).expect("the record is sound");
    let tool = tool();
    render(&Dossier::assemble(&tool, sources, None, None).expect("it is one product"))
}

/// Headings, states and gaps of a page, one a line.
fn outline(html: &str) -> String {
    let html = html.split("</style>").nth(1).expect("a page");
    let texts = html.split('<').filter_map(|piece| {
        let (tag, text) = piece.split_once('>')?;
        let level = tag.strip_prefix('h').filter(|rest| rest.len() == 1)?;
        Some(format!("{}{text}", "  ".repeat(level.parse().ok()?)))
    });
    texts.collect::<Vec<_>>().join("\n")
}

/// The part of a page from this heading to the end of its section.
fn chapter<'h>(html: &'h str, key: &str) -> &'h str {
    html.split(&format!("id=\"{key}\""))
        .nth(1)
        .and_then(|rest| rest.split("</section>").next())
        .unwrap_or_else(|| panic!("no {key}"))
}

#[test]
fn a_small_dossier_has_this_outline_and_these_gaps() {
    let html = page("dossier", &run(vec![passed(1), remarked(2), inconclusive(3)]));
    assert_snapshot!("dossier_outline", outline(&html));
    assert_snapshot!("dossier_gaps", chapter(&html, "gaps").replace("><", ">\n<"));
}

#[test]
fn a_statement_is_as_bad_as_its_worst_case() {
    for (cases, said) in [
        (vec![passed(1)], "✓ passed"),
        (vec![passed(1), remarked(2)], "● passed with remarks"),
        (vec![remarked(1), inconclusive(2)], "? inconclusive"),
        (vec![inconclusive(1), lost(2, Execution::Timeout)], "! not executed as meant"),
        (vec![lost(1, Execution::Timeout), failed(2), passed(3)], "✗ failed"),
        (vec![not_applicable(1), passed(2)], "✓ passed"),
        (vec![not_applicable(1)], "– does not apply"),
    ] {
        let html = page("dossier-worst", &run(cases));
        let rows = chapter(&html, "requirements");
        let row = rows.split("<tr").find(|row| row.contains("R-11.5.4.1-01")).expect("a row");
        assert!(row.contains(said), "{said}: {row:.400}");
    }
}

#[test]
fn every_state_is_told_with_its_statement() {
    let html = page("dossier-states", &run(vec![passed(1)]));
    let rows = chapter(&html, "requirements");
    for (id, said) in [
        ("R-1-RUN", "○ not run"),
        ("R-1-OTHER", "○ other side"),
        ("R-1-ORACLE", "✓ by the oracle"),
        ("R-1-IODD", "○ by fsct iodd"),
        ("R-1-BENCH", "□ bench"),
        ("R-1-READ", "□ inspection"),
        ("R-1-OPEN", "○ open"),
    ] {
        let row = rows.split("<tr").find(|row| row.contains(id)).unwrap_or_else(|| panic!("no {id}"));
        assert!(row.contains(said), "{row}");
    }
    assert!(!rows.contains("R-1-MASTER"), "it is about the other side");
}

#[test]
fn text_from_a_dut_is_escaped_wherever_it_is_printed() {
    let mut run = run(vec![hostile(1), CaseRecord { key: HOSTILE.into(), suite: HOSTILE.into(), ..hostile(2) }]);
    let text = || HOSTILE.to_owned();
    run.header.duts = vec![DutInfo {
        vendor: text(),
        product: text(),
        version: text(),
        profile: text(),
        url: text(),
        pcos: vec![text()],
        offers: vec![text()],
        declared: vec![(text(), text())],
        ..curtain()
    }];
    run.header.fsct = text();
    run.header.not_applicable.push((text(), text()));
    run.header.tolerances.insert(text(), text());
    run.cases[0].tolerances.insert(text(), text());
    let html = page("dossier-hostile", &run);
    for hostile in ["<script", "\u{0}", "\u{1b}", "\u{fffe}", "\u{202e}"] {
        assert!(!html.contains(hostile), "{hostile:?}");
    }
    assert!(html.contains("&lt;script&gt;alert(1)"), "it is shown");
}

#[test]
fn one_product_behind_two_addresses_is_one_product_and_what_differs_counts() {
    let mut run = run(vec![passed(1), CaseRecord { dut: 1, ..failed(1) }]);
    run.header.duts = vec![curtain(), DutInfo { url: "serial:/dev/ttyACM0".into(), ..curtain() }];
    let html = page("dossier-twice", &run);
    assert!(html.contains("serial:/dev/ttyACM0") && html.contains("✗ Not conformant"));
}
