//! A gateway that is no FS-Master: no clause about the SCL applies, what it shares is judged, what deviates is a remark.

mod cli;

use cli::{Folder, fsct};
use fsct_reference::GatewayMutant;

const PROFILE: &str = "gateway-f-di-f-do";

fn run(dut: &str, name: &str, suites: &[&str]) -> (cli::Outcome, Folder) {
    let out = Folder::new(name);
    let folder = out.out();
    let rest = ["--dut", dut, "--profile", PROFILE, "--out", &folder];
    (fsct(&[&["run"], suites, &rest].concat()), out)
}

#[test]
fn every_case_for_an_fs_master_is_not_applicable_with_the_reason() {
    let (outcome, out) = run("inproc:reference-gateway", "gateway", &[]);
    assert_eq!(outcome.code, 0, "{outcome:?}");
    assert!(outcome.out.contains("nothing above is a verdict on a clause of SDCI-FS"), "{}", outcome.out);
    let lines = out.lines();
    let left_out = lines[0]["header"]["not_applicable"].as_array().expect("a list");
    assert!(left_out.len() > 1_000, "{}", left_out.len());
    for entry in left_out {
        let (key, term) = (entry[0].as_str().unwrap_or_default(), entry[1].as_str().unwrap_or_default());
        assert!(key.starts_with("FSM-") && term.contains("no FS_PortMode"), "{key}: {term}");
    }
    let ran = lines.iter().filter_map(|line| line["case"]["id"].as_str());
    assert!(ran.clone().count() > 0 && ran.into_iter().all(|id| id.starts_with("GWM-")));
}

#[test]
fn that_a_fault_leaves_without_acknowledgment_is_a_remark() {
    let (outcome, out) = run("inproc:reference-gateway", "gateway-remark", &["gateway"]);
    assert_eq!(outcome.code, 0, "{outcome:?}");
    let remarks: Vec<String> = (out.lines().iter())
        .filter(|line| line["case"]["verdict"] == "remark")
        .map(|line| line["case"]["id"].as_str().unwrap_or_default().to_owned())
        .collect();
    assert_eq!(remarks, ["GWM-2104", "GWM-2104"]);
}

#[test]
fn every_mutant_fails_with_its_clause() {
    for mutant in GatewayMutant::ALL {
        let (outcome, _out) = run(&format!("inproc:reference-gateway?mutant={mutant}"), "gateway-mutant", &["gateway"]);
        assert_eq!(outcome.code, 1, "{mutant}: {outcome:?}");
        let section = mutant.clause().split(',').next().unwrap_or_default();
        let named = outcome.err.lines().any(|line| line.trim_start().starts_with("clause") && line.contains(section));
        assert!(named, "{mutant}, {section}: {}", outcome.err);
    }
}

#[test]
fn a_gateway_that_waits_for_the_operator_is_not_the_product() {
    let (outcome, _out) = run("inproc:reference-gateway?ack=operator", "gateway-operator", &["gateway"]);
    assert_eq!(outcome.code, 1, "{outcome:?}");
    let (outcome, _out) = run("inproc:reference-gateway?ack=nobody", "gateway-nobody", &["gateway"]);
    assert_eq!(outcome.code, 2, "{outcome:?}");
    assert!(outcome.err.contains("ack=auto and ack=operator"), "{}", outcome.err);
}

/// A DUT that never says GOOD passes nothing.
#[test]
fn a_dead_gateway_passes_no_case() {
    let (outcome, out) = run("inproc:null-master", "gateway-null", &["gateway"]);
    assert_eq!(outcome.code, 1, "{outcome:?}");
    assert_eq!(out.counts().get("ok pass"), None, "{:?}", out.counts());
}

#[test]
fn the_mapping_tells_its_findings() {
    let told = fsct(&["explain", "--mapping"]);
    assert_eq!(told.code, 0, "{told:?}");
    assert!(told.out.contains("finding: deviates L-13.5.1-03 (tested)"), "{}", told.out);
    assert!(told.out.lines().skip(1).all(|line| line.contains(" -> v1.1 ")), "{}", told.out);
}
