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

/// The mutants of the FS-Device against these cases.
fn against_cases(ids: &[&str]) -> Matrix {
    let mut library = Library::embedded().unwrap_or_else(|problems| panic!("{}", problems[0].render(false)));
    library.suites.iter_mut().for_each(|suite| suite.cases.retain(|case| ids.contains(&case.id.as_str())));
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
fn a_reading_that_is_let_pass_excuses_a_mutant_only_as_long_as_it_explains_everything() {
    let matrix = against_cases(&["FSD-0016", "FSD-0125", "FSD-0132"]);
    assert_eq!(mutant(&matrix, "all-zero-first").named_by, ["FSD-0016"]);
    // One answer to an error may be that of A08 with A16; the one after regular operation cannot.
    assert_eq!(mutant(&matrix, "t25-keeps-d-count").named_by, ["FSD-0132"]);
}

#[test]
fn a_partner_that_finds_no_operation_is_an_expectation_of_the_case() {
    let matrix = against_cases(&["FSD-0802"]);
    assert_eq!(mutant(&matrix, "zero-old-after-timeout").named_by, ["FSD-0802"]);
    // Whether the DUT goes on after the last step is no business of a case.
    assert!(mutant(&against_cases(&["FSD-0130"]), "t28-returns-to-26").killed_by.is_empty());
}

#[test]
fn what_is_withheld_is_safe_or_what_stood() {
    let matrix = against_cases(&["FSD-1554"]);
    assert_eq!(mutant(&matrix, "port-inverted-taken").named_by, ["FSD-1554"]);
}

#[test]
fn without_cases_everything_survives_and_nothing_is_clean() {
    let matrix = against(&[]);
    assert_eq!((matrix.survivors().count(), matrix.cases.len()), (matrix.mutants.len(), 0));
    let gauntlet = Gauntlet::new(vec![matrix], 0.0);
    assert!(!gauntlet.is_clean() && gauntlet.html().contains("of them survive"));
    assert!(!Gauntlet::new(Vec::new(), 0.0).is_clean(), "an empty gauntlet shows nothing");
}

#[test]
fn a_declared_structure_kills_what_counts_it_otherwise() {
    let matrix = against(&["device-io-data"]);
    for name in ["structure-counts-octets", "structure-counts-padding", "structure-types-swapped"] {
        let killed = mutant(&matrix, name);
        assert!(["FSD-2101", "FSD-2102"].iter().all(|id| killed.named_by.iter().any(|by| by == id)), "{killed:?}");
    }
    assert_eq!(mutant(&matrix, "padding-not-zero").named_by, ["FSD-2104"]);
    assert_eq!(matrix.idle().map(|case| case.id.as_str()).collect::<Vec<_>>(), Vec::<&str>::new());
}
