//! `testcases/limits.yaml` says what the standard says, in the units that lines are measured in.

use fsct_harness::library::Library;
use fsct_lines::{Bounds, Limit, Limits, Outside, Verify};
use fsct_protocol::Edition;
use rstest::rstest;

fn limits() -> Limits {
    Library::embedded().expect("the binary carries sound files").limits.limits
}

fn bounds(limit: &Limit, edition: Edition) -> Bounds {
    limit.bounds(edition, |_| None).expect("lines show it")
}

const MS: u64 = 1_000_000;
const S: u64 = 1_000_000_000;

#[rstest]
#[case("t_2R", (None, Some(5 * S)), (None, Some(5 * S)))]
#[case("FSP_TimeToReady", (None, None), (Some(10 * MS), Some(327_670 * MS)))]
#[case("t_RP", (Some(500_000), Some(MS)), (Some(500_000), Some(MS)))]
#[case("t_RW", (None, Some(50_000)), (None, Some(50_000)))]
#[case("t_RO", (Some(700_000), None), (Some(1_100 * MS), None))]
#[case("T_p", (Some(10 * MS), None), (None, None))]
#[case("t_i", (None, Some(MS)), (None, Some(MS)))]
#[case("t_i/T_p", (None, None), (None, Some(10_000_000)))]
#[case("t_dis", (None, Some(3 * MS)), (None, Some(MS)))]
#[case("t_disM", (None, Some(3 * MS)), (None, Some(3 * MS)))]
#[case("t_wait", (Some(5 * S), None), (Some(5 * S), None))]
#[case("t_off", (Some(S), None), (Some(S), None))]
#[case("t_WURQ", (Some(50_000), Some(700_000)), (Some(50_000), Some(1_100 * MS)))]
#[case("T_REN", (None, Some(500_000)), (None, Some(500_000)))]
#[case("T_WU", (Some(75_000), Some(85_000)), (Some(75_000), Some(85_000)))]
#[case("t_start_FS", (None, Some(S)), (None, Some(S)))]
#[case("FSP_Watchdog", (Some(MS), Some(65_535 * MS)), (Some(MS), Some(65_535 * MS)))]
fn times_of_both_editions(
    #[case] symbol: &str,
    #[case] v1_1: (Option<u64>, Option<u64>),
    #[case] iec2022: (Option<u64>, Option<u64>),
) {
    let limits = limits();
    let limit = limits.get(symbol).expect("it is in the file");
    for (edition, (min, max)) in [(Edition::V1_1, v1_1), (Edition::Iec2022, iec2022)] {
        match limit.row(edition) {
            Some(_) => assert_eq!(bounds(limit, edition), Bounds { min, max }, "{edition}"),
            None => assert_eq!((min, max), (None, None), "{edition}"),
        }
    }
}

#[test]
fn a_declaration_takes_the_place_of_the_printed_value() {
    let limits = limits();
    let declared = |name: &str| match name {
        "FSP_TimeToReady" => Some(0.05),
        "FSP_MinShutDownTime" => Some(1.5),
        "FSP_Watchdog" => Some(20.0),
        _ => None,
    };
    let of = |symbol: &str, edition| limits.get(symbol).and_then(|limit| limit.bounds(edition, declared));
    assert_eq!(of("t_2R", Edition::Iec2022), Some(Bounds { min: None, max: Some(50 * MS) }));
    assert_eq!(of("t_2R", Edition::V1_1), Some(Bounds { min: None, max: Some(5 * S) }), "5 s without exception");
    assert_eq!(of("t_off", Edition::Iec2022), Some(Bounds { min: Some(1_500 * MS), max: None }));
    assert_eq!(of("DTimer", Edition::V1_1), Some(Bounds { min: Some(20 * MS), max: None }));
    assert_eq!(of("V_THH", Edition::V1_1), None, "no line shows volts");
}

#[test]
fn the_base_standard_judges_nothing() {
    let limits = limits();
    for symbol in ["T_WU", "n_WU", "T_DMT", "T_DSIO", "T_SD"] {
        for edition in Edition::ALL {
            assert_eq!(limits.get(symbol).map(|limit| limit.outside(edition)), Some(Outside::Recorded), "{symbol}");
        }
    }
    let receive = limits.get("T_REN").expect("it is in the file");
    assert_eq!(receive.outside(Edition::V1_1), Outside::Fail, "v1.1 prints it");
    assert_eq!(receive.outside(Edition::Iec2022), Outside::Recorded);
}

/// A row that says nothing would judge nothing and look as if it did.
#[test]
fn every_row_has_a_value_or_judges_nothing() {
    for limit in limits().iter() {
        for row in Edition::ALL.into_iter().filter_map(|edition| limit.row(edition)) {
            let value = row.min.is_some() || row.max.is_some() || row.min_from.is_some() || row.max_from.is_some();
            assert!(value || row.outside == Outside::Recorded, "{}", limit.symbol);
        }
        let different = limit.v1_1.as_ref().map(|row| (row.min, row.max, row.outside))
            != limit.iec2022.as_ref().map(|row| (row.min, row.max, row.outside));
        let parameter = limit.verify == Verify::Read;
        assert!(
            !different || parameter || limit.why.is_some(),
            "{}: the editions differ, and nothing says why",
            limit.symbol
        );
    }
}
