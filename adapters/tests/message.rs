//! Every message goes through its octets and comes back; no octets are too wild to be looked at.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

use fsct_adapters::message::*;
use fsct_adapters::{
    Clock, ClockKind, Description, Identity, Line, Mode, Observation, Octets, Offer, Pco, Response, Role, Seen,
    Service, SmiRequest, SmiResult, SmiService, Source, Stimulus, Variant,
};
use fsct_protocol::{Edition, ProtMode};
use proptest::collection::vec;
use proptest::option;
use proptest::prelude::*;
use proptest::sample::{select, subsequence};
use rstest::rstest;

fn image() -> impl Strategy<Value = Octets> {
    vec(any::<u8>(), 0..=32).prop_map(|octets| Octets::new(&octets).unwrap())
}

fn service() -> impl Strategy<Value = Service> {
    select(&Service::ALL[..]).prop_map(|entry| entry.0)
}

fn edition() -> impl Strategy<Value = Edition> {
    select(&Edition::ALL[..])
}

fn mode() -> impl Strategy<Value = ProtMode> {
    select(&ProtMode::ALL[..])
}

fn stimulus() -> impl Strategy<Value = Stimulus> {
    prop_oneof![
        (edition(), mode(), any::<u8>(), any::<u8>())
            .prop_map(|(edition, mode, pd_out, pd_in)| Stimulus::Configure(Variant { edition, mode, pd_out, pd_in })),
        any::<bool>().prop_map(Stimulus::Power),
        (any::<u8>(), option::of(image())).prop_map(|(port, octets)| Stimulus::Exchange { port, octets }),
        (any::<u16>(), any::<u8>()).prop_map(|(index, subindex)| Stimulus::Read { index, subindex }),
        (any::<u16>(), any::<u8>(), vec(any::<u8>(), 0..=232)).prop_map(|(index, subindex, data)| Stimulus::Write {
            index,
            subindex,
            data
        }),
        (any::<u8>(), service(), image()).prop_map(|(port, service, value)| Stimulus::Set { port, service, value }),
        any::<u64>().prop_map(|ns| Stimulus::Advance { ns }),
        (any::<u8>(), option::of(identity())).prop_map(|(port, device)| Stimulus::Plug { port, device }),
        (any::<u8>(), response()).prop_map(|(port, response)| Stimulus::Respond { port, response }),
        (any::<u8>(), any::<u16>(), any::<u8>()).prop_map(|(port, code, qualifier)| Stimulus::Raise {
            port,
            code,
            qualifier
        }),
        (any::<u8>(), line(), any::<bool>()).prop_map(|(port, line, level)| Stimulus::Drive { port, line, level }),
        smi_request().prop_map(|request| Stimulus::Smi(Box::new(request))),
        (13..=u8::MAX, vec(any::<u8>(), 0..=255)).prop_map(|(kind, octets)| Stimulus::Other { kind, octets }),
    ]
}

fn line() -> impl Strategy<Value = Line> {
    select(&Line::ALL[..]).prop_map(|entry| entry.0)
}

fn identity() -> impl Strategy<Value = Identity> {
    // DeviceID has three octets.
    (any::<[u8; 5]>(), any::<u16>(), 0u32..1 << 24).prop_map(|(octets, vendor_id, device_id)| {
        let [revision_id, com, min_cycle_time, pd_in, pd_out] = octets;
        Identity { revision_id, com, min_cycle_time, pd_in, pd_out, vendor_id, device_id }
    })
}

fn response() -> impl Strategy<Value = Response> {
    prop_oneof![
        vec(any::<u8>(), 0..=232).prop_map(Response::Value),
        Just(Response::Written),
        any::<u16>().prop_map(Response::Refused),
    ]
}

fn smi_request() -> impl Strategy<Value = SmiRequest> {
    let service = select(&SmiService::ALL[..]).prop_map(|entry| entry.0);
    (service, any::<u8>(), any::<u16>(), any::<u16>(), vec(any::<u8>(), 0..=255)).prop_map(
        |(service, port, client_id, expected, octets)| SmiRequest { service, port, client_id, expected, octets },
    )
}

fn smi_result() -> impl Strategy<Value = SmiResult> {
    let numbers = (any::<u16>(), any::<u16>(), any::<u16>());
    (any::<u8>(), any::<bool>(), numbers, vec(any::<u8>(), 0..300)).prop_map(
        |(port, positive, (client_id, reference, length), octets)| SmiResult {
            port,
            client_id,
            positive,
            reference,
            length,
            octets,
        },
    )
}

fn observation() -> impl Strategy<Value = Observation> {
    let seen = prop_oneof![
        (any::<u8>(), option::of(image())).prop_map(|(port, octets)| Seen::Image { port, octets }),
        (any::<u8>(), service(), image()).prop_map(|(port, service, value)| Seen::Service { port, service, value }),
        vec(any::<u8>(), 0..=232).prop_map(Seen::Value),
        Just(Seen::Written),
        any::<u16>().prop_map(|error| Seen::Refused { error }),
        (any::<u16>(), any::<u8>()).prop_map(|(code, qualifier)| Seen::Event { code, qualifier }),
        Just(Seen::Unsupported),
        (any::<u8>(), select(&Mode::ALL[..])).prop_map(|(port, mode)| Seen::Mode { port, mode: mode.0 }),
        (any::<u8>(), any::<u16>(), any::<u8>(), option::of(vec(any::<u8>(), 0..=232)))
            .prop_map(|(port, index, subindex, data)| Seen::Request { port, index, subindex, data }),
        (any::<u8>(), line(), any::<bool>()).prop_map(|(port, line, level)| Seen::Line { port, line, level }),
        smi_result().prop_map(|result| Seen::Smi(Box::new(result))),
        (any::<u8>(), select(&[Source::Device, Source::Port][..]), any::<u8>(), any::<u16>())
            .prop_map(|(port, source, qualifier, code)| Seen::Indication { port, source, qualifier, code }),
    ];
    (any::<u16>(), any::<u64>(), seen).prop_map(|(stimulus, at, seen)| Observation { stimulus, at, seen })
}

fn description() -> impl Strategy<Value = Description> {
    let range = || (any::<u8>(), any::<u8>());
    let offer = (edition(), mode(), range(), range()).prop_map(|(edition, mode, pd_out, pd_in)| Offer {
        edition,
        mode,
        pd_out,
        pd_in,
    });
    let clock = (select(&[ClockKind::Virtual, ClockKind::Real][..]), any::<u64>(), any::<u64>())
        .prop_map(|(kind, resolution_ns, uncertainty_ns)| Clock { kind, resolution_ns, uncertainty_ns });
    let role = select(&[Role::Device, Role::Master][..]);
    let pcos = subsequence(Pco::ALL.to_vec(), 0..=Pco::ALL.len());
    (role, any::<u8>(), pcos, vec(offer, 0..6), clock, ["\\PC{0,60}", "\\PC{0,60}", "\\PC{0,60}"]).prop_map(
        |(role, ports, pcos, offers, clock, [vendor, product, version])| Description {
            role,
            ports,
            pcos,
            offers,
            clock,
            vendor,
            product,
            version,
        },
    )
}

proptest! {
    #[test]
    fn hello_comes_back(min: u8, max: u8, later in vec(any::<u8>(), 0..3)) {
        let payload = [&Hello { min, max }.pack()[..], &later].concat();
        prop_assert_eq!(Hello::unpack(&payload), Ok(Hello { min, max }));
    }

    #[test]
    fn a_description_comes_back(description in description(), payload in MIN_PAYLOAD..=0xFFFF, requests in 1u8..) {
        let limits = Limits { payload, requests };
        let packed = pack_description(&description, limits);
        prop_assert_eq!(unpack_description(&packed), Ok(Described::As(description, limits)));
    }

    #[test]
    fn parts_of_later_versions_are_passed_over(description in description(), tag in 10u8.., value in vec(any::<u8>(), 0..50)) {
        let mut packed = pack_description(&description, Limits::LEAST);
        packed.extend([tag, 0, value.len() as u8]);
        packed.extend(value);
        prop_assert_eq!(unpack_description(&packed), Ok(Described::As(description, Limits::LEAST)));
    }

    #[test]
    fn another_version_is_all_that_is_read(version in 2u8.., rest in vec(any::<u8>(), 0..50)) {
        let payload = [&[version][..], &rest].concat();
        prop_assert_eq!(unpack_description(&payload), Ok(Described::Foreign(version)));
    }

    #[test]
    fn stimuli_come_back(stimuli in vec(stimulus(), 0..40), limit in MIN_PAYLOAD..4000usize, most in 0usize..50) {
        let mut payload = Vec::new();
        let packed = pack_apply(&stimuli, limit, most, &mut payload);
        prop_assert!(payload.len() <= limit);
        prop_assert!(packed == stimuli.len() || packed == most || packed > 0);
        prop_assert_eq!(unpack_apply(&payload), Ok(stimuli[..packed].to_vec()));
    }

    #[test]
    fn observations_come_back(observations in vec(observation(), 0..40), limit in MIN_PAYLOAD..4000usize) {
        let mut payload = Vec::new();
        let packed = pack_observed(&observations, limit, &mut payload);
        prop_assert!(payload.len() <= limit && (packed > 0 || observations.is_empty()));
        let mut unpacked = Vec::new();
        prop_assert_eq!(unpack_observed(&payload, &mut unpacked), Ok(packed < observations.len()));
        prop_assert_eq!(&unpacked[..], &observations[..packed]);
    }

    #[test]
    fn a_text_comes_back_as_far_as_it_fits(text in "\\PC{0,300}") {
        let packed = pack_error(&text);
        prop_assert!(packed.len() <= MAX_TEXT && packed.len() + 4 > text.len().min(MAX_TEXT));
        prop_assert!(text.starts_with(&unpack_error(&packed)));
    }

    #[test]
    fn no_payload_is_too_wild(payload in vec(any::<u8>(), 0..200)) {
        let _ = Hello::unpack(&payload);
        let _ = unpack_description(&payload);
        let _ = unpack_description(&[&[VERSION][..], &payload].concat());
        let _ = unpack_apply(&payload);
        let _ = unpack_observed(&payload, &mut Vec::new());
        let _ = unpack_error(&payload);
    }

    #[test]
    fn a_cut_payload_is_malformed(stimuli in vec(stimulus(), 1..5), cut in any::<prop::sample::Index>()) {
        let mut payload = Vec::new();
        pack_apply(&stimuli, 0xFFFF, 5, &mut payload);
        prop_assert!(unpack_apply(&payload[..cut.index(payload.len())]).is_err());
    }
}

/// Kinds 1 to 12 with a value they cannot have, and kinds nobody knows.
#[rstest]
#[case::configure_of_another_edition(1, &[3, 1, 0, 0])]
#[case::configure_of_another_mode(1, &[1, 3, 0, 0])]
#[case::configure_too_short(1, &[1, 1, 0])]
#[case::power_half_on(2, &[2])]
#[case::exchange_neither_lost_nor_there(3, &[1, 2])]
#[case::exchange_lost_with_octets(3, &[1, 0, 7])]
#[case::exchange_of_33_octets(3, &[1; 35])]
#[case::read_without_subindex(4, &[0, 0])]
#[case::write_without_subindex(5, &[0, 0])]
#[case::service_8(6, &[1, 8])]
#[case::service_26(6, &[0, 26])]
#[case::advance_of_7_octets(7, &[0; 7])]
#[case::never_assigned(0, &[])]
#[case::plug_into_nowhere(8, &[])]
#[case::plug_of_9_octets(8, &[1; 10])]
#[case::plug_of_11_octets(8, &[1; 12])]
#[case::respond_nothing(9, &[1])]
#[case::respond_in_a_fourth_way(9, &[1, 4])]
#[case::respond_written_with_octets(9, &[1, 2, 0])]
#[case::respond_with_half_an_error_type(9, &[1, 3, 0x80])]
#[case::respond_with_more_than_an_error_type(9, &[1, 3, 0x80, 0x22, 0])]
#[case::raise_without_qualifier(10, &[1, 0xB0, 0])]
#[case::drive_line_0(11, &[1, 0, 1])]
#[case::drive_line_5(11, &[1, 5, 1])]
#[case::drive_half_high(11, &[1, 2, 2])]
#[case::drive_without_level(11, &[1, 2])]
#[case::smi_service_0(12, &[0, 1, 0, 0, 0, 0])]
#[case::smi_service_19(12, &[19, 1, 0, 0, 0, 0])]
#[case::smi_without_its_numbers(12, &[1, 1, 0, 0, 0])]
#[case::later_version(13, &[1, 2, 3])]
#[case::made_up(255, &[0; 300])]
fn what_is_not_known_is_kept_to_be_answered_unsupported(#[case] kind: u8, #[case] value: &[u8]) {
    let length = (value.len() as u16).to_be_bytes();
    let payload = [&[0, 2, kind][..], &length, value, &[2, 0, 1, 1]].concat();
    let unknown = Stimulus::Other { kind, octets: value.to_vec() };
    assert_eq!(unpack_apply(&payload), Ok(vec![unknown, Stimulus::Power(true)]));
}

#[rstest]
#[case(&[], "the payload ends within the number of stimuli")]
#[case(&[0, 1, 2, 0], "the payload ends within a stimulus")]
#[case(&[0, 1, 2, 0, 2, 1], "the payload ends within a stimulus")]
#[case(&[0, 2, 2, 0, 1, 1], "2 stimuli are announced, 1 are there")]
#[case(&[0, 0, 2, 0, 1, 1], "0 stimuli are announced, 1 are there")]
fn malformed_stimuli(#[case] payload: &[u8], #[case] text: &str) {
    assert_eq!(unpack_apply(payload).unwrap_err().to_string(), text);
}

#[rstest]
#[case(1, &[1], "an image has 1 octets")]
#[case(1, &[1, 2], "the presence of an image is 2, which version 1 does not know")]
#[case(1, &[1; 35], "an image has 35 octets")]
#[case(1, &[1, 0, 9], "an image has 3 octets")]
#[case(2, &[1], "a service has 1 octets")]
#[case(2, &[1, 8, 0], "a service is 8, which version 1 does not know")]
#[case(3, &[0; 233], "a value read has 233 octets")]
#[case(4, &[0], "the answer to a write has 1 octets")]
#[case(5, &[0], "a refusal has 1 octets")]
#[case(6, &[0, 0], "an Event has 2 octets")]
#[case(7, &[0], "an answer \"unsupported\" has 1 octets")]
#[case(8, &[1], "a mode has 1 octets")]
#[case(8, &[1, 2, 3], "a mode has 3 octets")]
#[case(8, &[1, 4], "a mode is 4, which version 1 does not know")]
#[case(9, &[1, 0, 0x42, 2], "on-request data has 4 octets")]
#[case(9, &[1, 0, 0x42, 2, 0, 9], "a read of on-request data has 6 octets")]
#[case(9, &[1; 238], "a write of on-request data has 238 octets")]
#[case(9, &[1, 2, 0x42, 2, 0], "the direction of on-request data is 2, which version 1 does not know")]
#[case(10, &[1, 1], "a line has 2 octets")]
#[case(10, &[1, 0, 1], "a line is 0, which version 1 does not know")]
#[case(10, &[1, 5, 1], "a line is 5, which version 1 does not know")]
#[case(10, &[1, 1, 2], "the level of a line is 2, which version 1 does not know")]
#[case(11, &[1, 1, 0, 0, 0, 0, 0], "the result of an SMI service has 7 octets")]
#[case(11, &[1, 2, 0, 0, 0, 0, 0, 0], "the sign of a result is 2, which version 1 does not know")]
#[case(12, &[1, 1, 0x74, 0x20], "an Event indicated by an FS-Master has 4 octets")]
#[case(12, &[1, 1, 0x74, 0x20, 2, 0], "an Event indicated by an FS-Master has 6 octets")]
#[case(12, &[1, 3, 0x74, 0x20, 2], "the source of an Event is 3, which version 1 does not know")]
#[case(13, &[], "the kind of an observation is 13, which version 1 does not know")]
fn malformed_observations(#[case] kind: u8, #[case] value: &[u8], #[case] text: &str) {
    let payload = [&[0, 0, 0][..], &[0; 8], &[kind, 0, value.len() as u8], value].concat();
    assert_eq!(unpack_observed(&payload, &mut Vec::new()).unwrap_err().to_string(), text);
}

#[rstest]
#[case(&[], "the payload ends within the version")]
#[case(&[1], "the list of PCOs is missing")]
#[case(&[1, 1, 0, 1, 3], "the role is 3, which version 1 does not know")]
#[case(&[1, 1, 0, 2, 1, 1], "the role has 2 octets")]
#[case(&[1, 1, 0, 1, 1, 1, 0, 1, 1], "the role is given twice")]
#[case(&[1, 4, 0, 1, 1], "an offer has 1 octets")]
#[case(&[1, 4, 0, 6, 3, 1, 0, 0, 0, 0], "the edition of an offer is 3, which version 1 does not know")]
#[case(&[1, 4, 0, 6, 1, 0, 0, 0, 0, 0], "the mode of an offer is 0, which version 1 does not know")]
#[case(&[1, 5, 0, 1, 3], "the kind of the clock is 3, which version 1 does not know")]
#[case(&[1, 5, 0, 1, 1], "the payload ends within the clock")]
#[case(&[1, 9, 0, 1, 1], "the part about limits has 1 octets")]
fn malformed_descriptions(#[case] payload: &[u8], #[case] text: &str) {
    assert_eq!(unpack_description(payload).unwrap_err().to_string(), text);
}

#[test]
fn a_text_of_256_octets_is_malformed_and_bad_utf8_is_replaced() {
    let with_vendor = |vendor: &[u8]| {
        let start = pack_description(
            &Description {
                role: Role::Device,
                ports: 1,
                pcos: vec![],
                offers: vec![],
                clock: Clock { kind: ClockKind::Real, resolution_ns: 0, uncertainty_ns: 0 },
                vendor: String::new(),
                product: String::new(),
                version: String::new(),
            },
            Limits::LEAST,
        );
        // The three empty texts and the limits are the last 9 and 6 octets.
        let [high, low] = (vendor.len() as u16).to_be_bytes();
        unpack_description(&[&start[..start.len() - 15], &[6, high, low], vendor].concat())
    };
    assert_eq!(with_vendor(&[b'x'; 256]), Err(Malformed::Length { field: "the vendor", found: 256 }));
    let Ok(Described::As(description, limits)) = with_vendor(b"caf\xE9") else { panic!("it is well formed") };
    assert_eq!((description.vendor.as_str(), description.product.as_str()), ("caf\u{FFFD}", ""));
    assert_eq!(limits, Limits::LEAST);
}
