//! FS-Devices that read an open point of the standard in another way: taken where the tolerance is in force, and named;
//! refused where it is not.

use super::device::{Link, Shown, pdout, sd};
use super::*;
use crate::oracle::DeviceOracle;
use fsct_adapters::Octets;
use rstest::rstest;

type Line = (Vec<u8>, Shown);

fn good(mcount: u8, shown: Shown) -> Line {
    (m(mcount, 0, 0, PDOUT), shown)
}

fn bad(mcount: u8, shown: Shown) -> Line {
    (hit(m(mcount, 0, 0, PDOUT)), shown)
}

/// The last line is where the reading shows.
#[rstest]
#[case::a09_jump_ignored("DCount_i", &[9], vec![good(6, pdout(4))])]
#[case::a09_ignored_again("DCount_i", &[9], vec![good(6, pdout(4)), good(7, pdout(4)), good(4, pdout(3)), good(6, pdout(3))])]
#[case::a11_sdset_while_set_sd("SDset", &[11], vec![(m(4, 1, 0, [0; 2]), sd(3, 1, 0, 0))])]
#[case::a28_pdin_zero_with_sdset("PDin", &[28], vec![bad(4, Shown { pdin: PDIN, ..sd(3, 1, 1, 0) }), good(5, Shown { pdin: [0; 2], ..sd(2, 1, 1, 0) })])]
#[case::a29_error_in_a_repetition("DCommErr", &[29], vec![bad(3, sd(4, 1, 1, 0))])]
#[case::a08_previous_is_the_last_valid("DCount_i", &[8, 16], vec![bad(4, sd(4, 1, 1, 0))])]
#[case::a19_behind_an_expiry("DCommErr", &[19], vec![(vec![], sd(4, 1, 0, 1)), bad(4, sd(3, 1, 1, 1)), good(5, sd(2, 1, 0, 0))])]
#[case::a19_sequential("DCommErr", &[19], vec![bad(4, sd(3, 1, 1, 0)), bad(5, sd(2, 1, 1, 0)), good(6, sd(1, 1, 0, 0))])]
fn a_reading_is_taken_by_its_tolerance_alone(#[case] kind: &str, #[case] numbers: &[u8], #[case] lines: Vec<Line>) {
    use fsct_adapters::Service;
    let begin = |setup| {
        let mut link = Link::operating(setup);
        if kind == "PDin" {
            link.oracle.input(Service::PdinD, &Octets::new(&PDIN).expect("two octets"));
        }
        link
    };
    // No SPDU: the watchdog expires.
    let go = |link: &mut Link, (spdu, shown): &Line| match spdu.as_slice() {
        [] => link.exchange(WATCHDOG, None, shown),
        spdu => link.exchange(CYCLE, Some(spdu), shown),
    };
    let mut link = begin(tolerant(Role::Device, numbers));
    for line in &lines {
        assert_eq!(go(&mut link, line), Ok(()), "{:?}", line.1);
    }
    assert_eq!(link.used(), numbers);
    let mut link = begin(strict(Role::Device));
    let refusal = lines.iter().find_map(|line| go(&mut link, line).err());
    assert_eq!(refusal.expect("nothing is tolerated here").kind, kind);
    // Tolerances of another number do not help.
    let others: Vec<u8> = (1..=38).filter(|number| !numbers.contains(number)).collect();
    let mut link = begin(tolerant(Role::Device, &others));
    let refusal = lines.iter().find_map(|line| go(&mut link, line).err());
    assert_eq!(refusal.expect("the others do not help").kind, kind);
}

#[rstest]
#[case::the_default(false)]
#[case::the_other(true)]
fn a_reading_once_shown_is_kept(#[case] ignores: bool) {
    let jump = m(6, 0, 0, PDOUT);
    let mut link = Link::operating(tolerant(Role::Device, &[9]));
    if ignores {
        link.takes(&jump, pdout(4));
        link.refuses(&jump, sd(1, 1, 1, 0), "DCount_i");
    } else {
        link.takes(&jump, sd(1, 1, 1, 0));
        link.refuses(&m(2, 0, 0, PDOUT), sd(1, 1, 1, 0), "DCount_i");
        assert!(link.used().is_empty());
    }
}

#[test]
fn a08_goes_on_with_the_last_valid_counter() {
    let mut link = Link::operating(tolerant(Role::Device, &[8, 16]));
    link.takes(&hit(m(4, 0, 0, PDOUT)), sd(4, 1, 1, 0));
    link.says(4, sd(3, 1, 1, 0));
    link.takes(&hit(m(6, 0, 0, PDOUT)), sd(3, 1, 1, 0));
    let mut link = Link::operating(tolerant(Role::Device, &[8, 16]));
    link.takes(&hit(m(4, 0, 0, PDOUT)), sd(3, 1, 1, 0));
    link.refuses(&hit(m(5, 0, 0, PDOUT)), sd(3, 1, 1, 0), "DCount_i");
}

#[test]
fn a29_restarts_the_watchdog_and_never_takes_data() {
    let mut link = Link::operating(tolerant(Role::Device, &[29]));
    link.says(3, pdout(4));
    assert!(link.used().is_empty(), "an intact repetition is no error");
    link.refuses(&m(3, 0, 0, PDOUT), sd(4, 1, 1, 0), "DCommErr");
    let mut link = Link::operating(tolerant(Role::Device, &[29]));
    link.takes(&hit(m(3, 0, 0, PDOUT)), pdout(4));
    link.says(4, pdout(3));
    assert!(link.used().is_empty(), "dropping it is the default");
}

#[rstest]
#[case::v1_1(Edition::V1_1, &[31], true)]
#[case::not_tolerated(Edition::V1_1, &[], false)]
#[case::iec2022(Edition::Iec2022, &[31], false)]
fn a31_a_first_spdu_with_mcount_1(#[case] edition: Edition, #[case] allowed: &[u8], #[case] taken: bool) {
    let bench = || Link::ready(Setup { edition, ..tolerant(Role::Device, allowed) });
    let first = m(1, 0, 0, PDOUT);
    let mut link = bench();
    if taken {
        link.takes(&first, sd(6, 1, 0, 0));
        link.says(2, sd(5, 1, 0, 0));
        assert_eq!(link.used(), [31]);
    } else {
        link.refuses(&first, sd(6, 1, 0, 0), "DCommErr");
    }
    bench().takes(&first, sd(6, 1, 1, 1));
    let second = m(2, 0, 0, PDOUT);
    bench().refuses(&second, sd(5, 1, 0, 0), "DCommErr");
    bench().refuses(&hit(first), sd(6, 1, 0, 0), "DCommErr");
}

#[test]
fn a32_dtimeout_may_be_either_in_the_answer_to_a_bad_first_spdu() {
    let first = hit(m(0, 0, 0, PDOUT));
    let mut link = Link::ready(tolerant(Role::Device, &[32]));
    link.takes(&first, sd(7, 1, 1, 0));
    assert_eq!(link.used(), [32]);
    let mut link = Link::ready(tolerant(Role::Device, &[32]));
    link.takes(&first, sd(7, 1, 1, 1));
    assert!(link.used().is_empty());
    link.refuses(&m(1, 0, 0, PDOUT), sd(6, 1, 1, 1), "DTimeout");
    Link::ready(strict(Role::Device)).refuses(&first, sd(7, 1, 1, 0), "DTimeout");
    Link::ready(tolerant(Role::Device, &[33])).refuses(&first, sd(7, 1, 1, 0), "DTimeout");
}

/// Where a tolerance is in force, it is about its own answers alone.
#[rstest]
#[case::a09_not_the_first(&[9], 0, m(5, 0, 0, PDOUT), Shown { status: (0, 0, 0, 0), ..sd(0, 0, 0, 0) }, "DCount_i")]
#[case::a09_not_one_that_is_hit(&[9], 4, hit(m(4, 0, 0, PDOUT)), pdout(4), "DCount_i")]
#[case::a11_not_in_operation(&[11], 4, m(4, 0, 0, PDOUT), Shown { status: (3, 1, 0, 0), ..pdout(3) }, "SDset")]
#[case::a11_not_in_sd_cycles(&[11], 2, m(2, 1, 0, PDOUT), sd(5, 0, 0, 0), "SDset")]
#[case::a11_not_when_hit(&[11], 4, hit(m(4, 1, 0, PDOUT)), sd(3, 0, 1, 0), "SDset")]
#[case::a33_not_dtimeout_from_nowhere(&[33], 4, hit(m(4, 0, 0, PDOUT)), sd(3, 1, 1, 1), "DTimeout")]
fn a_tolerance_covers_nothing_else(
    #[case] allowed: &[u8],
    #[case] from: u8,
    #[case] spdu: Vec<u8>,
    #[case] shown: Shown,
    #[case] kind: &str,
) {
    let mut link = Link::ready(tolerant(Role::Device, allowed));
    for mcount in 0..from {
        link.says(mcount, if mcount < 3 { sd(7 - mcount, 1, 0, 0) } else { pdout(7 - mcount) });
    }
    link.refuses(&spdu, shown, kind);
}

/// State 26 after T31, or with DCommErr standing.
fn expired(allowed: &[u8]) -> Link {
    let mut link = Link::operating(tolerant(Role::Device, allowed));
    assert_eq!(link.exchange(WATCHDOG + MARGIN, None, &sd(4, 1, 0, 1)), Ok(()));
    link
}

#[test]
fn a33_the_other_error_bit_may_be_either() {
    let mut link = expired(&[33]);
    link.takes(&hit(m(4, 0, 0, PDOUT)), sd(3, 1, 1, 0));
    assert_eq!(link.used(), [33]);
    let mut link = expired(&[33]);
    link.takes(&hit(m(4, 0, 0, PDOUT)), sd(3, 1, 1, 1));
    assert!(link.used().is_empty());
    expired(&[32]).refuses(&hit(m(4, 0, 0, PDOUT)), sd(3, 1, 1, 0), "DTimeout");
    // T30 behind an error.
    let behind = |allowed: &[u8]| {
        let mut link = Link::operating(tolerant(Role::Device, allowed));
        link.takes(&hit(m(4, 0, 0, PDOUT)), sd(3, 1, 1, 0));
        (link.exchange(WATCHDOG + MARGIN, None, &sd(3, 1, 0, 1)), link.used())
    };
    assert_eq!(behind(&[33]), (Ok(()), vec![33]));
    refused(behind(&[]).0, "DCommErr");
}

#[test]
fn a33_is_about_the_answer_of_the_expiry_and_no_other() {
    let mut link = expired(&[33]);
    link.refuses(&m(4, 0, 0, PDOUT), sd(3, 1, 1, 1), "DCommErr");
    expired(&[33]).refuses(&m(4, 0, 0, PDOUT), sd(3, 1, 0, 0), "DTimeout");
    let second = expired(&[33]).exchange(WATCHDOG + MARGIN, None, &sd(4, 1, 1, 1));
    refused(second, "DCommErr");
}

#[test]
fn a18_an_image_before_the_first_spdu() {
    let early = |allowed: &[u8]| {
        let mut oracle = DeviceOracle::new(tolerant(Role::Device, allowed));
        oracle.power(true);
        oracle.parameterized(0);
        (oracle.exchange(CYCLE, None, Some(&d((7, 1, 0, 0), [0; 2])), &nothing()), oracle.set().used())
    };
    assert_eq!(early(&[18]), (Ok(()), Mask::NONE.with(18)));
    refused(early(&[]).0, "image");
}
