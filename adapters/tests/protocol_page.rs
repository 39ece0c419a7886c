//! `PROTOCOL.md` says what the code does: its dumps, its numbers, its limits.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

use fsct_adapters::frame::{Decoder, Frame, MAX_GARBAGE, SYNC, checksum, encode};
use fsct_adapters::message::*;
use fsct_adapters::smi::error_info;
use fsct_adapters::{
    Clock, ClockKind, Description, FLOOD_PER_STIMULUS, FLOOD_SLACK, Identity, Line, Mode, Observation, Octets, Offer,
    Pco, REPLY_TIMEOUT, Response, Role, Seen, Service, SmiRequest, SmiResult, SmiService, Source, Stimulus,
};
use fsct_protocol::fsp::{Authenticity, INDEX_VERIFY, IoStructure, IoTotals, Protocol, VerifyRecord};
use fsct_protocol::smi::{FS_PORT_CONFIG_LIST, SAFETYCOM};
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

fn master() -> Description {
    Description {
        role: Role::Master,
        ports: 2,
        pcos: Pco::ALL.to_vec(),
        vendor: String::new(),
        product: String::new(),
        version: String::new(),
        ..description()
    }
}

fn identity() -> Identity {
    Identity {
        revision_id: 0x11,
        com: 3,
        min_cycle_time: 10,
        pd_in: 7,
        pd_out: 7,
        vendor_id: 0x1234,
        device_id: 0x56_789A,
    }
}

fn io_structure() -> IoStructure {
    let side = IoTotals { range: 7, bits: 24, octets: 3, int16: 0, int32: 0 };
    IoStructure { version: 1, input: side, output: side }
}

fn record() -> VerifyRecord {
    let io_struct_crc = io_structure().signature();
    VerifyRecord {
        authenticity: Authenticity { authenticity_1: 1, authenticity_2: 2, port: 1 },
        protocol: Protocol { version: 1, mode: 1, watchdog_ms: 100, io_struct_crc, tech_par_crc: 7 },
    }
}

/// The FSPortConfigList that makes an FS-Master send [`record`] to the Device of [`identity`].
fn port_config() -> Vec<u8> {
    let edition = Edition::Iec2022;
    let (record, io, device) = (record(), io_structure(), identity());
    let mut list = vec![0; FS_PORT_CONFIG_LIST.length(edition)];
    for (name, value) in [
        ("ArgBlockID", FS_PORT_CONFIG_LIST.id(edition).unwrap().into()),
        ("PortMode", SAFETYCOM.into()),
        ("Validation&Backup", 2),
        ("VendorID", device.vendor_id.into()),
        ("DeviceID", device.device_id),
        ("FSP_TimeToReady", 50),
        ("FSP_MinShutDownTime", 100),
        ("FSP_Authenticity1", record.authenticity.authenticity_1),
        ("FSP_Authenticity2", record.authenticity.authenticity_2),
        ("FSP_Port", record.authenticity.port.into()),
        ("FSP_AuthentCRC", record.authenticity.signature().into()),
        ("FSP_ProtVersion", record.protocol.version.into()),
        ("FSP_ProtMode", record.protocol.mode.into()),
        ("FSP_Watchdog", record.protocol.watchdog_ms.into()),
        ("FSP_IO_StructCRC", record.protocol.io_struct_crc.into()),
        ("FSP_TechParCRC", record.protocol.tech_par_crc),
        ("FSP_ProtParCRC", record.protocol.signature().into()),
        ("IO_DescVersion", io.version.into()),
        ("SPDUInLength", io.input.range.into()),
        ("TotalOfInBits", io.input.bits.into()),
        ("TotalOfInOctets", io.input.octets.into()),
        ("SPDUOutLength", io.output.range.into()),
        ("TotalOfOutBits", io.output.bits.into()),
        ("TotalOfOutOctets", io.output.octets.into()),
    ] {
        FS_PORT_CONFIG_LIST.field(name).unwrap().put(edition, &mut list, value);
    }
    list
}

fn smi_request() -> SmiRequest {
    SmiRequest {
        service: SmiService::FsMasterAccess,
        port: 0,
        client_id: 0x1234,
        expected: 0x0101,
        octets: [&[0x01, 0x00][..], &[0; 9]].concat(),
    }
}

fn smi_result() -> SmiResult {
    let octets = vec![0x01, 0x01, 0, 0, 0, 1, 0, 0, 0, 2];
    SmiResult { port: 0, client_id: 0x1234, positive: true, reference: 0x0100, length: 10, octets }
}

/// What a dump of stimuli or observations holds.
enum Held {
    Stimuli(Vec<Stimulus>),
    Observations(Vec<Observation>),
}

/// The dumps about an FS-Master with their sequence numbers, in their order.
fn held() -> Vec<(&'static str, u8, Held)> {
    let seen = |stimulus, at, seen| Observation { stimulus, at, seen };
    let drive = |level| Stimulus::Drive { port: 1, line: Line::Cq, level };
    let mode = |mode| Seen::Mode { port: 1, mode };
    let line = |line| Seen::Line { port: 1, line, level: true };
    let advance = |ns| Stimulus::Advance { ns };
    let given = octets(&[0, 0, 0, 1, 0, 0, 0, 2]);
    let set = Stimulus::Set { port: 0, service: Service::FscpAuthenticity, value: given };
    let result = |result| Held::Observations(vec![seen(1, 0, Seen::Smi(Box::new(result)))]);
    let refused = SmiResult {
        positive: false,
        reference: 0,
        length: 0,
        octets: error_info::STATE_CONFLICT.to_be_bytes().to_vec(),
        ..smi_result()
    };
    let configure = SmiRequest {
        service: SmiService::PortConfiguration,
        port: 1,
        client_id: 0x1235,
        expected: 0xFFF0,
        octets: port_config(),
    };
    let configured = SmiResult {
        port: 1,
        client_id: 0x1235,
        positive: true,
        reference: 0x8100,
        length: 2,
        octets: vec![0xFF, 0xF0],
    };
    let verify = Some(record().to_octets().to_vec());
    let indication = Seen::Indication { port: 1, source: Source::Device, qualifier: 0xF4, code: 0xB002 };
    vec![
        ("smi", 5, Held::Stimuli(vec![set, Stimulus::Smi(Box::new(smi_request()))])),
        ("smi-result", 5, result(smi_result())),
        ("smi-refused", 5, result(refused)),
        ("configure-port", 6, Held::Stimuli(vec![Stimulus::Smi(Box::new(configure))])),
        (
            "port-configured",
            6,
            Held::Observations(vec![seen(0, 0, line(Line::Power)), seen(0, 0, Seen::Smi(Box::new(configured)))]),
        ),
        ("plug", 7, Held::Stimuli(vec![Stimulus::Plug { port: 1, device: Some(identity()) }, advance(5_000_000)])),
        ("plugged", 7, Held::Observations(vec![])),
        ("ready-pulse", 8, Held::Stimuli(vec![drive(true), advance(700_000), drive(false), advance(2_000_000)])),
        (
            "started",
            8,
            Held::Observations(vec![
                seen(3, 5_750_000, line(Line::WakeUp)),
                seen(3, 6_000_000, mode(Mode::Startup)),
                seen(3, 7_000_000, mode(Mode::Preoperate)),
                seen(3, 7_000_000, Seen::Request { port: 1, index: INDEX_VERIFY, subindex: 0, data: verify }),
            ]),
        ),
        (
            "respond",
            9,
            Held::Stimuli(vec![
                Stimulus::Respond { port: 1, response: Response::Written },
                advance(1_000_000),
                Stimulus::Raise { port: 1, code: 0xB002, qualifier: 0xF4 },
            ]),
        ),
        (
            "operating",
            9,
            Held::Observations(vec![seen(0, 7_700_000, mode(Mode::Operate)), seen(2, 8_700_000, indication)]),
        ),
    ]
}

/// What the page claims of each dump, in its order.
fn claims() -> Vec<(&'static str, Frame)> {
    let frame = |kind, sequence, payload| Frame { kind, sequence, payload };
    let held = held().into_iter().map(|(name, sequence, held)| {
        let (kind, payload) = match held {
            Held::Stimuli(stimuli) => (APPLY, apply(&stimuli)),
            Held::Observations(observations) => (OBSERVED, observed(&observations)),
        };
        (name, frame(kind, sequence, payload))
    });
    let mut claims = vec![
        ("hello", frame(HELLO, 0, Hello::OURS.pack().to_vec())),
        ("description", frame(DESCRIPTION, 0, pack_description(&description(), Limits::LEAST))),
        ("apply", frame(APPLY, 1, apply(&cycle()))),
        ("observed", frame(OBSERVED, 1, observed(&cycle_seen()))),
        ("made-up", frame(APPLY, 2, apply(&[made_up()]))),
        ("unsupported", frame(OBSERVED, 2, observed(&[unsupported()]))),
        ("error", frame(ERROR, 3, pack_error("unknown message 44"))),
        ("version-2", frame(DESCRIPTION, 0, vec![2])),
        ("master", frame(DESCRIPTION, 4, pack_description(&master(), Limits::LEAST))),
    ];
    claims.extend(held);
    claims
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
    assert_eq!(unpack_description(&payload("master")), Ok(Described::As(master(), Limits::LEAST)));
    for (name, _, held) in held() {
        match held {
            Held::Stimuli(stimuli) => assert_eq!(unpack_apply(&payload(name)), Ok(stimuli)),
            Held::Observations(observations) => assert_eq!(unpack(name), observations),
        }
    }
}

/// The page without its line ends.
fn flowing() -> String {
    PAGE.split_whitespace().collect::<Vec<_>>().join(" ")
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
    assert_eq!(numbered("| number | service | of | |"), entries(Service::ALL));
}

/// Numbers and names of a table whose rows begin with them.
fn numbered(head: &str) -> Vec<(String, &'static str)> {
    table(head).iter().map(|row| (row[0].to_owned(), row[1].trim_matches('`'))).collect()
}

/// The same of a table of the contract.
fn entries<T, N: ToString>(all: impl IntoIterator<Item = (T, N, &'static str)>) -> Vec<(String, &'static str)> {
    all.into_iter().map(|(_, number, name)| (number.to_string(), name)).collect()
}

#[test]
fn the_lines_modes_and_smi_services_are_those_of_the_contract() {
    assert_eq!(numbered("| number | line | pin | changed by |"), entries(Line::ALL));
    assert_eq!(numbered("| number | mode | meaning |"), entries(Mode::ALL));
    assert_eq!(numbered("| number | service | |"), entries(SmiService::ALL));
}

#[test]
fn the_error_infos_are_those_of_the_contract() {
    let code = [
        ((), error_info::OUT_OF_RANGE, "OUT_OF_RANGE"),
        ((), error_info::STATE_CONFLICT, "STATE_CONFLICT"),
        ((), error_info::NO_COM, "NO_COM"),
    ];
    assert_eq!(numbered("| number | ErrorInfo |"), entries(code));
}

/// The number of a response is the octet behind number of stimuli, TLV head and port.
#[test]
fn the_responses_are_those_of_the_code() {
    let response = |response| apply(&[Stimulus::Respond { port: 1, response }])[6];
    let code = [
        ((), response(Response::Value(vec![])), "value"),
        ((), response(Response::Written), "written"),
        ((), response(Response::Refused(0)), "refused"),
    ];
    assert_eq!(numbered("| number | response | octets behind the number |"), entries(code));
}

/// Changing a field of an identity changes the octets that the table gives it, and no others.
#[test]
fn the_identity_has_the_octets_of_the_page() {
    let pack = |identity| apply(&[Stimulus::Plug { port: 1, device: Some(identity) }])[6..].to_vec();
    let zero = Identity { revision_id: 0, com: 0, min_cycle_time: 0, pd_in: 0, pd_out: 0, vendor_id: 0, device_id: 0 };
    let fields = [
        ("RevisionID", Identity { revision_id: 0xFF, ..zero }),
        ("COM", Identity { com: 0xFF, ..zero }),
        ("MinCycleTime", Identity { min_cycle_time: 0xFF, ..zero }),
        ("process data in", Identity { pd_in: 0xFF, ..zero }),
        ("process data out", Identity { pd_out: 0xFF, ..zero }),
        ("VendorID", Identity { vendor_id: 0xFFFF, ..zero }),
        ("DeviceID", Identity { device_id: 0xFF_FFFF, ..zero }),
    ];
    let rows = table("| octets | field of the identity | value |");
    assert_eq!(rows.iter().map(|row| row[1]).collect::<Vec<_>>(), fields.map(|field| field.0));
    let mut at = 0;
    for (row, (name, identity)) in rows.iter().zip(fields) {
        let count: usize = row[0].parse().unwrap();
        let expected = [vec![0; at], vec![0xFF; count], vec![0; 10 - at - count]].concat();
        assert_eq!(pack(identity), expected, "{name}");
        at += count;
    }
    assert_eq!(at, 10);
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
#[case("plug", Stimulus::Plug { port: 1, device: None })]
#[case("respond", Stimulus::Respond { port: 1, response: Response::Written })]
#[case("raise", Stimulus::Raise { port: 1, code: 0, qualifier: 0 })]
#[case("drive", Stimulus::Drive { port: 1, line: Line::Cq, level: true })]
#[case("smi", Stimulus::Smi(Box::new(smi_request())))]
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
#[case("mode", Seen::Mode { port: 1, mode: Mode::Inactive })]
#[case("request", Seen::Request { port: 1, index: 0, subindex: 0, data: None })]
#[case("line", Seen::Line { port: 1, line: Line::Power, level: true })]
#[case("smi", Seen::Smi(Box::new(smi_result())))]
#[case("indication", Seen::Indication { port: 1, source: Source::Port, qualifier: 0, code: 0 })]
fn the_observations_have_the_kinds_of_the_page(#[case] name: &str, #[case] seen: Seen) {
    let rows = table("| kind | observation | value |");
    let row = rows.iter().find(|row| row[1] == name).unwrap();
    assert_eq!(row[0], observed(&[Observation { stimulus: 0, at: 0, seen }])[11].to_string());
}

/// What the page says belongs to later versions is unknown to the code, and the kind before it is known.
#[test]
fn no_kind_is_left_out() {
    let kinds = |head| table(head).iter().filter_map(|row| row[0].parse().ok()).max();
    let last: u8 = kinds("| kind | stimulus | value |").unwrap();
    let (later, known) = (format!("Kinds 0 and {}..199 belong to later versions", last + 1), 12);
    assert!(flowing().contains(&later), "{later}");
    assert_eq!((last, kinds("| kind | observation | value |").unwrap()), (known, known));
    let unknown = [0, 1, known + 1, 0, 0];
    assert_eq!(unpack_apply(&unknown), Ok(vec![Stimulus::Other { kind: known + 1, octets: vec![] }]));
    let unknown = [&[0; 11][..], &[known + 1, 0, 0]].concat();
    assert!(unpack_observed(&unknown, &mut Vec::new()).is_err());
}

/// The number of a source is the octet behind the port.
#[rstest]
#[case::of_a_device(Source::Device, 1)]
#[case::of_a_port(Source::Port, 2)]
fn the_sources_of_an_indication_are_those_of_the_page(#[case] source: Source, #[case] number: u8) {
    assert!(PAGE.contains("source (1 = Device, 2 = port)"));
    let seen = Seen::Indication { port: 1, source, qualifier: 0, code: 0 };
    assert_eq!(observed(&[Observation { stimulus: 0, at: 0, seen }])[15], number);
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
    let text = flowing();
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
