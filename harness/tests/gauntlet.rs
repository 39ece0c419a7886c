//! The gauntlet itself: a case kills by its own expectations alone, and what kills nothing or survives is told.

use fsct_adapters::Role;
use fsct_harness::gauntlet::matrix;
use fsct_harness::library::Library;
use fsct_reports::gauntlet::{Gauntlet, Matrix, Mutant};

/// The mutants of the FS-Device against these suites.
fn against(suites: &[&str]) -> Matrix {
    let mut library = Library::embedded().unwrap_or_else(|problems| panic!("{}", problems[0].render(false)));
    library.suites.retain(|suite| suites.contains(&suite.name.as_str()));
    matrix(&library, Role::Device, &|| ()).unwrap_or_else(|problem| panic!("{}", problem.render(false)))
}

fn mutant<'m>(matrix: &'m Matrix, name: &str) -> &'m Mutant {
    matrix.mutants.iter().find(|mutant| mutant.name == name).unwrap_or_else(|| panic!("there is no mutant {name}"))
}

#[test]
fn a_case_about_the_counter_kills_what_is_wrong_with_the_counter() {
    let matrix = against(&["device-counter"]);
    let killed = mutant(&matrix, "counter-check-missing");
    assert!(killed.named_by.contains(&"FSD-0202".to_owned()), "{killed:?}");
    assert_eq!(killed.oracle, None, "the oracle was not needed");
    let survivor = mutant(&matrix, "watchdog-doubled");
    // FSD-0202 trips over it, but judges another clause: that is not enough.
    assert!(!survivor.killed_by.is_empty() && survivor.named_by.is_empty(), "{survivor:?}");
    assert!(matrix.survivors().any(|other| other == survivor) && survivor.oracle == Some(true), "{survivor:?}");
    let case = matrix.cases.iter().find(|case| case.id == "FSD-0202").expect("it is in the suite");
    assert!(case.kills > 0 && matrix.idle().all(|idle| idle.id != case.id));
}

#[test]
fn without_cases_everything_survives_and_nothing_is_clean() {
    let matrix = against(&[]);
    assert_eq!((matrix.survivors().count(), matrix.cases.len()), (matrix.mutants.len(), 0));
    let gauntlet = Gauntlet { roles: vec![matrix], seconds: 0.0 };
    assert!(!gauntlet.is_clean() && gauntlet.html().contains("of them survive"));
    assert!(!Gauntlet { roles: Vec::new(), seconds: 0.0 }.is_clean(), "an empty gauntlet shows nothing");
}
