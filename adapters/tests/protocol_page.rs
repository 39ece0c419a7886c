//! `PROTOCOL.md` says what the code does: its dumps, its numbers, its limits.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

use fsct_adapters::frame::{Decoder, Frame, MAX_GARBAGE, SYNC, checksum, encode};
use fsct_adapters::message::*;
use fsct_adapters::{
    Clock, ClockKind, Description, FLOOD_PER_STIMULUS, FLOOD_SLACK, Observation, Octets, Offer, Pco, REPLY_TIMEOUT,
    Role, Seen, Service, Stimulus,
};
use fsct_protocol::{Edition, ProtMode};
use rstest::rstest;
use std::collections::BTreeSet;

const PAGE: &str = include_str!("../PROTOCOL.md");

/// Name and octets of every dump.
fn dumps() -> Vec<(&'static str, Vec<u8>)> {
    let blocks = PAGE.split("```hex ").skip(1).map(|block| block.split("```").next().unwrap());
    let dump = |block: &'static str| {
        let (name, lines) = block.split_once('\n').unwrap();
        let octets = lines.lines().flat_map(|line| line.split('#').next().unwrap().split_whitespace());
        (name, octets.map(|octet| u8::from_str_radix(octet, 16).unwrap()).collect())
    };
    blocks.map(dump).collect()
}

fn octets(octets: &[u8]) -> Octets {
    Octets::new(octets).unwrap()
}

fn apply(stimuli: &[Stimulus]) -> Vec<u8> {
    let mut payload = Vec::new();
    assert_eq!(pack_apply(stimuli, MIN_PAYLOAD, 256, &mut payload), stimuli.len());
    payload
}

fn observed(observations: &[Observation]) -> Vec<u8> {
    let mut payload = Vec::new();
    assert_eq!(pack_observed(observations, MIN_PAYLOAD, &mut payload), observations.len());
    payload
}

fn description() -> Description {
    Description {
        role: Role::Device,
        ports: 1,
        pcos: vec![Pco::Power, Pco::Link, Pco::Acyclic, Pco::App, Pco::Clock],
        offers: vec![Offer { edition: Edition::Iec2022, mode: ProtMode::Crc16, pd_out: (0, 3), pd_in: (0, 3) }],
        clock: Clock { kind: ClockKind::Virtual, resolution_ns: 1000, uncertainty_ns: 0 },
        vendor: "Example".to_owned(),
        product: "demo".to_owned(),
        version: "1.0".to_owned(),
    }
}

fn cycle() -> [Stimulus; 2] {
    let spdu = octets(&[0x11, 0x22, 0x33, 0x01, 0x20, 0xA5, 0x91]);
    [Stimulus::Advance { ns: 1_000_000 }, Stimulus::Exchange { port: 1, octets: Some(spdu) }]
}

fn cycle_seen() -> [Observation; 2] {
    let at = |seen| Observation { stimulus: 1, at: 1_000_000, seen };
    let image = octets(&[0x44, 0x55, 0x66, 0xFE, 0xC0, 0xB1, 0x4D]);
    [
        at(Seen::Service { port: 1, service: Service::PdoutD, value: octets(&[0x11, 0x22, 0x33]) }),
        at(Seen::Image { port: 1, octets: Some(image) }),
    ]
}

fn made_up() -> Stimulus {
    Stimulus::Other { kind: 200, octets: vec![1, 2, 3] }
}

fn unsupported() -> Observation {
    Observation { stimulus: 0, at: 1_000_000, seen: Seen::Unsupported }
}

/// What the page claims of each dump, in its order.
fn claims() -> Vec<(&'static str, Frame)> {
    let frame = |kind, sequence, payload| Frame { kind, sequence, payload };
    vec![
        ("hello", frame(HELLO, 0, Hello::OURS.pack().to_vec())),
        ("description", frame(DESCRIPTION, 0, pack_description(&description(), Limits::LEAST))),
        ("apply", frame(APPLY, 1, apply(&cycle()))),
        ("observed", frame(OBSERVED, 1, observed(&cycle_seen()))),
        ("made-up", frame(APPLY, 2, apply(&[made_up()]))),
        ("unsupported", frame(OBSERVED, 2, observed(&[unsupported()]))),
        ("error", frame(ERROR, 3, pack_error("unknown message 44"))),
        ("version-2", frame(DESCRIPTION, 0, vec![2])),
    ]
}

#[test]
fn the_dumps_are_what_the_code_sends() {
    let sent = |(name, frame): (_, Frame)| (name, encode(frame.kind, frame.sequence, &frame.payload).unwrap());
    assert_eq!(dumps(), claims().into_iter().map(sent).collect::<Vec<_>>());
}

#[test]
fn the_dumps_decode_to_what_the_page_claims() {
    let payload = |name| {
        let (_, octets) = dumps().into_iter().find(|dump| dump.0 == name).unwrap();
        let mut decoder = Decoder::new();
        decoder.push(&octets);
        decoder.next_frame().unwrap().payload
    };
    let unpack = |name| {
        let mut observations = Vec::new();
        assert_eq!(unpack_observed(&payload(name), &mut observations), Ok(false));
        observations
    };
    assert_eq!(Hello::unpack(&payload("hello")), Ok(Hello { min: 1, max: 1 }));
    assert_eq!(unpack_description(&payload("description")), Ok(Described::As(description(), Limits::LEAST)));
    assert_eq!(unpack_description(&payload("version-2")), Ok(Described::Foreign(2)));
    assert_eq!(unpack_apply(&payload("apply")), Ok(cycle().to_vec()));
    assert_eq!(unpack_apply(&payload("made-up")), Ok(vec![made_up()]));
    assert_eq!(unpack("observed"), cycle_seen());
    assert_eq!(unpack("unsupported"), [unsupported()]);
    assert_eq!(unpack_error(&payload("error")), "unknown message 44");
}

/// The cells of the table that begins with this row.
fn table(head: &str) -> Vec<Vec<&'static str>> {
    let rows = PAGE.lines().skip_while(|line| *line != head).take_while(|line| line.starts_with('|'));
    let cells = |line: &'static str| line.trim_matches('|').split('|').map(str::trim).collect();
    let rows: Vec<_> = rows.skip(2).map(cells).collect();
    assert!(!rows.is_empty(), "no table {head}");
    rows
}

#[test]
fn the_services_are_those_of_the_contract() {
    let page: Vec<_> =
        table("| number | service | of | |").iter().map(|row| (row[0], row[1].trim_matches('`'))).collect();
    let numbers: Vec<_> = Service::ALL.iter().map(|entry| entry.1.to_string()).collect();
    let code: Vec<_> = numbers.iter().map(String::as_str).zip(Service::ALL.map(|entry| entry.2)).collect();
    assert_eq!(page, code);
}

#[test]
fn the_pcos_are_those_of_the_contract() {
    let page: Vec<_> = table("| bit | PCO | you serve |").iter().map(|row| (row[0].parse().unwrap(), row[1])).collect();
    assert_eq!(page, (0usize..).zip(Pco::ALL.map(Pco::name)).collect::<Vec<_>>());
}

#[test]
fn the_messages_are_those_of_the_code() {
    let page: Vec<_> = table("| type | message | direction | payload |")
        .iter()
        .map(|row| (u8::from_str_radix(row[0], 16).unwrap(), row[1]))
        .collect();
    let code =
        [(HELLO, "HELLO"), (DESCRIPTION, "DESCRIPTION"), (APPLY, "APPLY"), (OBSERVED, "OBSERVED"), (ERROR, "ERROR")];
    assert_eq!(page, code);
}

/// Name in the page, and one of it; the number is the octet behind the number of stimuli.
#[rstest]
#[case("configure", Stimulus::Configure(fsct_adapters::Variant { edition: Edition::V1_1, mode: ProtMode::Crc16, pd_out: 0, pd_in: 0 }))]
#[case("power", Stimulus::Power(true))]
#[case("exchange", Stimulus::Exchange { port: 1, octets: None })]
#[case("read", Stimulus::Read { index: 0, subindex: 0 })]
#[case("write", Stimulus::Write { index: 0, subindex: 0, data: vec![] })]
#[case("set", Stimulus::Set { port: 1, service: Service::PdinD, value: Octets::zero(1) })]
#[case("advance", Stimulus::Advance { ns: 1 })]
fn the_stimuli_have_the_kinds_of_the_page(#[case] name: &str, #[case] stimulus: Stimulus) {
    let rows = table("| kind | stimulus | value |");
    let row = rows.iter().find(|row| row[1] == name).unwrap();
    assert_eq!(row[0], apply(&[stimulus])[2].to_string());
}

/// Name in the page, and one of it; the number is the octet behind flags, stimulus and time.
#[rstest]
#[case("image", Seen::Image { port: 1, octets: None })]
#[case("service", Seen::Service { port: 1, service: Service::PdoutD, value: Octets::zero(1) })]
#[case("value", Seen::Value(vec![]))]
#[case("written", Seen::Written)]
#[case("refused", Seen::Refused { error: 0 })]
#[case("event", Seen::Event { code: 0, qualifier: 0 })]
#[case("unsupported", Seen::Unsupported)]
fn the_observations_have_the_kinds_of_the_page(#[case] name: &str, #[case] seen: Seen) {
    let rows = table("| kind | observation | value |");
    let row = rows.iter().find(|row| row[1] == name).unwrap();
    assert_eq!(row[0], observed(&[Observation { stimulus: 0, at: 0, seen }])[11].to_string());
}

#[test]
fn the_tags_of_a_description_are_those_of_the_code() {
    let page: BTreeSet<u8> = table("| tag | what | value | |").iter().map(|row| row[0].parse().unwrap()).collect();
    let packed = pack_description(&description(), Limits::LEAST);
    let mut code = BTreeSet::new();
    let mut rest = &packed[1..];
    while let [tag, high, low, after @ ..] = rest {
        code.insert(*tag);
        rest = &after[usize::from(u16::from_be_bytes([*high, *low]))..];
    }
    assert_eq!(page, code);
}

#[test]
fn the_limits_are_those_of_the_code() {
    let text = PAGE.split_whitespace().collect::<Vec<_>>().join(" ");
    let [first, second] = SYNC;
    for claim in [
        format!("`{first:02X} {second:02X}`"),
        format!("`123456789` it is **{:08X}**", checksum(b"123456789")),
        format!("gives up after {MAX_GARBAGE} octets"),
        format!("At most {FLOOD_PER_STIMULUS} observations a stimulus plus {FLOOD_SLACK} a request"),
        format!("come within {} s of", REPLY_TIMEOUT.as_secs()),
        format!("frames with {MIN_PAYLOAD} octets of payload"),
        format!("One APPLY holds up to {MAX_STIMULI} stimuli"),
        format!("UTF-8 of at most {MAX_TEXT} octets"),
        format!("describes version {VERSION} of the messages"),
    ] {
        assert!(text.contains(&claim), "{claim}");
    }
}
