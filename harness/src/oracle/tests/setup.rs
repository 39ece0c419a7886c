//! What the oracle is told of bench and product.

use super::*;
use crate::oracle::{Readings, Stance, Tolerances};
use crate::problem::Source;
use fsct_adapters::{Octets, Service};
use rstest::rstest;
use std::sync::Arc;

#[rstest]
#[case(Role::Device, 3, 5, 2)]
#[case(Role::Master, 5, 3, 0xFD)]
fn sizes_and_port_by_role(#[case] role: Role, #[case] image: usize, #[case] sent: usize, #[case] port: u8) {
    let setup = Setup { pd_in: 3, pd_out: 5, port: Port::new(2).unwrap(), ..strict(role) };
    assert_eq!((setup.image_pd(), setup.sent_pd(), setup.sent_port()), (image, sent, port));
}

#[test]
fn an_image_of_all_zero_or_too_short_is_no_spdu() {
    let setup = strict(Role::Device);
    let view = |octets: &[u8]| setup.view(Octets::new(octets).as_ref()).map(|view| view.port_num());
    assert_eq!(view(&d((7, 1, 0, 0), PDIN)), Some(0xFE));
    assert_eq!((view(&[0; 6]), view(&[1; 5]), setup.view(None).is_none()), (None, None, true));
}

#[test]
fn every_output_service_is_kept_apart() {
    let value = Octets::bit(true);
    let reported = |service| {
        let mut app = App::default();
        app.report(service, value);
        app
    };
    let (octets, bit, none) = (Some(value), Some(true), App::default());
    assert_eq!(reported(Service::PdoutD), App { pdout_d: octets, ..none });
    assert_eq!(reported(Service::SetsdDc), App { set_sd_dc: bit, ..none });
    assert_eq!(reported(Service::ChfackreqDc), App { ch_f_ack_req_dc: bit, ..none });
    assert_eq!(reported(Service::SclFault), App { scl_fault: bit, ..none });
    assert_eq!(reported(Service::PdinM), App { pdin_m: octets, ..none });
    assert_eq!(reported(Service::SdsetS), App { sdset_s: bit, ..none });
    assert_eq!(reported(Service::ChfackreqS), App { ch_f_ack_req_s: bit, ..none });
    assert_eq!(reported(Service::FaultsS), App { faults_s: bit, ..none });
    assert_eq!(reported(Service::Qualifier), App { qualifier: bit, ..none });
    assert_eq!(reported(Service::PdinD), none);
}

#[test]
fn a_mask_is_a_set_of_numbers() {
    let mask = Mask::NONE.with(2).with(38);
    assert_eq!(mask.iter().collect::<Vec<_>>(), [2, 38]);
    assert_eq!((mask.has(2), mask.has(3), mask.len(), mask.is_empty()), (true, false, 2, false));
    assert_eq!(mask.with(2), mask);
    assert_eq!(mask.without(2).iter().collect::<Vec<_>>(), [38]);
    assert_eq!(mask.without(3), mask);
    assert_eq!(mask.union(Mask::NONE.with(3).with(2)).iter().collect::<Vec<_>>(), [2, 3, 38]);
    assert!(Mask::NONE.is_empty());
}

fn source(text: String) -> Arc<Source> {
    Arc::new(Source { name: "tolerances.yaml".into(), text })
}

#[test]
fn the_table_says_what_is_in_force_and_what_is_shown() {
    let stances = ["tolerated", "finding", "open", "refused", "recognised", "settled"];
    let entry = |(number, stance): (usize, &&str)| {
        format!("- {{id: A{:02}, name: n{number}, stance: {stance}, text: some}}\n", number + 1)
    };
    let text: String = stances.iter().enumerate().map(entry).collect();
    let table = Tolerances::parse(&source(text)).expect("it is a table");
    assert_eq!(table.in_force().iter().collect::<Vec<_>>(), [1, 2, 3]);
    assert_eq!(table.shown().iter().collect::<Vec<_>>(), [1, 2, 4, 5, 6]);
    assert_eq!(table.iter().map(|entry| entry.stance.to_string()).collect::<Vec<_>>(), stances);
    assert_eq!(table.get(4).map(|entry| (entry.name.as_str(), entry.stance)), Some(("n3", Stance::Refused)));
    assert!(table.get(7).is_none());
    assert!(Tolerances::parse(&source("- {id: A39, name: n, stance: open, text: t}".into())).is_err());
}

#[rstest]
#[case("A01", Some(1))]
#[case("A38", Some(38))]
#[case("A39", None)]
#[case("A00", None)]
#[case("A1", None)]
#[case("A001", None)]
#[case("B01", None)]
fn ids_of_tolerances(#[case] id: &str, #[case] number: Option<u8>) {
    assert_eq!(Tolerances::number(id), number);
}

/// What a tolerance lets pass is held against what was proven.
#[rstest]
#[case("stance: open, device: [A19=one]", &["`A19=one` is no reading of A19 for an FS-Device"])]
#[case("stance: tolerated, device: [A19=sequential]", &["A19=sequential cannot be tolerated, no product may follow it: P2d fails"])]
#[case("stance: open, device: [A19=sequential]", &["A19=sequential cannot be open"])]
#[case("stance: tolerated", &["A19 is tolerated and does not say which of its readings is let pass: device: A19=sequential"])]
#[case("stance: finding, device: [A19=sequential]", &[])]
#[case("stance: refused", &[])]
fn a_reading_that_was_refused_is_not_let_pass(#[case] stance: &str, #[case] expected: &[&str]) {
    let proven = "- {machine: FS-Device, reading: A19=sequential, verdict: refused, why: P2d fails}".to_owned();
    let proven = Readings::parse(&source(proven)).expect("it is a table");
    let tolerances = source(format!("- {{id: A19, name: n, {stance}, text: t}}"));
    let table = Tolerances::parse(&tolerances).expect("it is a table");
    let problems = proven.check(&tolerances, &table);
    assert_eq!(problems.len(), expected.len(), "{problems:?}");
    for (problem, expected) in problems.iter().zip(expected) {
        assert!(format!("{problem:?}").contains(expected), "{problem:?}");
    }
}
