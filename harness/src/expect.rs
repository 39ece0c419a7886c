//! Expectations of a case against what was seen.

mod port;

use crate::case::model::{Declared, EVENT_TYPES, Expectation, Expected, Key, RecordField};
use crate::session::{Reply, Session};
use crate::tester::Tester;
use crate::trace::hex;
use fsct_adapters::{Octets, Pco, Role};
use fsct_iodd::Declaration;
use fsct_protocol::Edition;
use fsct_protocol::fsp::{Authenticity, Protocol};
use fsct_protocol::spdu::{View, succ};
use fsct_reports::record::Check;

/// What stood before a step, for `unchanged`.
#[derive(Clone, Debug, Default)]
pub struct Before {
    image: Option<Octets>,
    pdout_d: Option<Octets>,
    pdin_m: Option<Octets>,
    count: Option<u8>,
}

impl Before {
    /// What stands now.
    pub fn now(session: &Session<'_>) -> Before {
        Before {
            image: session.link().image,
            pdout_d: session.link().app.pdout_d,
            pdin_m: session.link().app.pdin_m,
            count: session.answer().map(|view| view.counter()),
        }
    }
}

/// Judges one expectation. `None`: it cannot be judged on this DUT, because the service is not served or the direction
/// has no process data.
pub fn judge(expectation: &Expectation, before: &Before, session: &Session<'_>, tester: &Tester) -> Option<Check> {
    let (expected, observed, met) = match expectation.key {
        Key::DcountI | Key::SdSet | Key::DcommErr | Key::Dtimeout => {
            answer_field(expectation, before, session, tester)?
        }
        Key::Mcount | Key::SetSd | Key::ChFAckReq => spdu_field(expectation, before, session)?,
        Key::PortNum | Key::Reserved => frame_field(expectation, session),
        Key::Pdin if expectation.value == Expected::Padded => padding(session)?,
        Key::Pdin => pdin(expectation, session)?,
        Key::Structure => structure(session)?,
        Key::Pdout => pdout(expectation, session)?,
        Key::Image => image(expectation, before, session),
        Key::Nsr => nsr(expectation, session),
        Key::PdoutD | Key::SetSdDc | Key::ChFAckReqDc => service(expectation, before, session, tester)?,
        Key::PdinM | Key::SdsetS | Key::ChFAckReqS | Key::FaultsS | Key::Qualifier => {
            gateway(expectation, before, session, tester)?
        }
        Key::Reply => reply(expectation, session)?,
        Key::Event => event(expectation, session),
        Key::EventType => event_type(expectation, session)?,
        Key::Mode | Key::PortPower | Key::Cq | Key::Iq | Key::WakeUp | Key::Record => {
            port::of_port(expectation, session)
        }
        Key::DataStorage | Key::Stored => port::of_specimen(expectation, session)?,
        Key::Result | Key::Reference | Key::Length | Key::Block | Key::Field(_) => {
            port::of_result(expectation, session)
        }
    };
    Some(Check { key: expectation.key.name().to_owned(), expected, observed, met })
}

fn number(expectation: &Expectation) -> u32 {
    match expectation.value {
        Expected::Number(number) => number,
        _ => 0,
    }
}

type Judged = (String, String, bool);

fn compare<T: PartialEq + ToString>(expected: T, observed: Option<T>) -> Judged {
    let met = observed.as_ref() == Some(&expected);
    (expected.to_string(), observed.map_or_else(|| "no SPDU".to_owned(), |value| value.to_string()), met)
}

fn answer_field(expectation: &Expectation, before: &Before, session: &Session<'_>, tester: &Tester) -> Option<Judged> {
    let status = session.answer().map(|view| view.status());
    let observed = status.map(|status| {
        u32::from(match expectation.key {
            Key::DcountI => status.dcount_i,
            Key::SdSet => status.sd_set.into(),
            Key::DcommErr => status.d_comm_err.into(),
            _ => status.d_timeout.into(),
        })
    });
    let expected = match expectation.value {
        Expected::Mirror => u32::from(tester.mirror()?),
        Expected::Unchanged => u32::from(before.count?),
        _ => number(expectation),
    };
    Some(compare(expected, observed))
}

/// What an SPDU of either side carries beside counters and data.
fn frame_field(expectation: &Expectation, session: &Session<'_>) -> Judged {
    let (view, setup) = (session.answer(), session.setup());
    if expectation.key == Key::PortNum {
        let right = match setup.role {
            Role::Device => setup.port.inverted(),
            Role::Master => setup.port.number(),
        };
        let expected = if expectation.value == Expected::Right { right.into() } else { number(expectation) };
        return compare(expected, view.map(|view| view.port_num().into()));
    }
    let reserved = |view: View<'_>| {
        let known = match setup.role {
            Role::Device => view.status().to_octet(),
            Role::Master => view.control().to_octet(),
        };
        u32::from(view.octet() & !known)
    };
    compare(number(expectation), view.map(reserved))
}

/// What follows the SPDU in the image.
fn nsr(expectation: &Expectation, session: &Session<'_>) -> Judged {
    let setup = session.setup();
    let length = setup.mode.spdu_octets(setup.image_pd());
    let seen = session.link().image.map(|octets| hex(octets.as_slice().get(length..).unwrap_or_default()));
    let expected = match &expectation.value {
        Expected::Octets(octets) => hex(octets),
        _ => String::new(),
    };
    compare(expected, seen)
}

fn spdu_field(expectation: &Expectation, before: &Before, session: &Session<'_>) -> Option<Judged> {
    let control = session.answer().map(|view| view.control());
    let observed = control.map(|control| {
        u32::from(match expectation.key {
            Key::Mcount => control.mcount,
            Key::SetSd => control.set_sd.into(),
            _ => control.ch_f_ack_req.into(),
        })
    });
    let expected = match expectation.value {
        Expected::Next => u32::from(succ(before.count?)),
        Expected::Unchanged => u32::from(before.count?),
        _ => number(expectation),
    };
    Some(compare(expected, observed))
}

fn event(expectation: &Expectation, session: &Session<'_>) -> Judged {
    let seen: Vec<String> = session.events.iter().map(|(code, _)| format!("0x{code:04X}")).collect();
    let seen = if seen.is_empty() { "no Event".to_owned() } else { seen.join(", ") };
    match &expectation.value {
        Expected::None => ("no Event".to_owned(), seen, session.events.is_empty()),
        Expected::Unreserved => {
            let setup = session.setup();
            let met = !session.events.iter().any(|(code, _)| reserved(setup.role, setup.edition, *code));
            ("no Event with a reserved code".to_owned(), seen, met)
        }
        Expected::Events(none, codes) => {
            let met =
                (*none || !session.events.is_empty()) && session.events.iter().all(|(code, _)| codes.contains(code));
            (format!("Event {}", expectation.text), seen, met)
        }
        _ => {
            let wanted = number(expectation);
            let met = session.events.iter().any(|(code, _)| u32::from(*code) == wanted);
            (format!("Event 0x{wanted:04X}"), seen, met)
        }
    }
}

/// `None` without an Event.
fn event_type(expectation: &Expectation, session: &Session<'_>) -> Option<Judged> {
    let types: Vec<u8> = session.events.iter().map(|(_, qualifier)| qualifier >> 4 & 3).collect();
    let word = |number: &u8| EVENT_TYPES.iter().find(|entry| entry.0 == *number).map_or("reserved", |entry| entry.1);
    let seen: Vec<&str> = types.iter().map(word).collect();
    let met = matches!(&expectation.value, Expected::Types(wanted) if types.iter().all(|seen| wanted.contains(seen)));
    (!types.is_empty()).then(|| (expectation.text.clone(), seen.join(", "), met))
}

/// Whether Annex B reserves an EventCode that a Device (Table B.1) or an FS-Master (Table B.2) raises itself.
fn reserved(role: Role, edition: Edition, code: u16) -> bool {
    match (role, edition) {
        (Role::Device, Edition::V1_1) => matches!(code, 0xB00A..=0xB0FF),
        (Role::Device, Edition::Iec2022) => matches!(code, 0xB00B..=0xB0FF),
        (Role::Master, Edition::V1_1) => matches!(code, 0xB007 | 0xB008 | 0xB00A..=0xB0FF),
        (Role::Master, Edition::Iec2022) => {
            matches!(code, 0x2004 | 0x2007 | 0x2008 | 0x200A..=0x20EF | 0x20F1..=0x20FF)
        }
    }
}

fn pdout(expectation: &Expectation, session: &Session<'_>) -> Option<Judged> {
    let setup = session.setup();
    if setup.pd_out == 0 || (expectation.value == Expected::Live && !session.serves(Pco::App)) {
        return None;
    }
    let expected = match &expectation.value {
        Expected::Live => hex(session.link().input.as_slice()),
        Expected::Octets(octets) => hex(octets),
        _ => hex(&vec![0; setup.pd_out]),
    };
    Some(compare(expected, session.answer().map(|view| hex(view.pd()))))
}

fn gateway(expectation: &Expectation, before: &Before, session: &Session<'_>, tester: &Tester) -> Option<Judged> {
    if !session.serves(Pco::App) {
        return None;
    }
    let app = &session.link().app;
    let bit = match expectation.key {
        Key::SdsetS => app.sdset_s,
        Key::ChFAckReqS => app.ch_f_ack_req_s,
        Key::FaultsS => app.faults_s,
        Key::Qualifier => {
            let word = |good: bool| if good { "GOOD" } else { "BAD" };
            let (expected, seen) = (word(number(expectation) == 1), app.qualifier.map(word));
            return Some((expected.to_owned(), seen.unwrap_or("not reported").to_owned(), seen == Some(expected)));
        }
        _ => {
            if session.setup().pd_in == 0 && session.link().ossde.is_none() {
                return None;
            }
            let expected = match &expectation.value {
                Expected::Live => hex(tester.pd.octets()),
                Expected::Unchanged => hex(before.pdin_m?.as_slice()),
                Expected::Octets(octets) => hex(octets),
                _ => hex(&vec![0; app.pdin_m.map_or(session.setup().pd_in, |pdin| pdin.as_slice().len())]),
            };
            return Some(compare(expected, app.pdin_m.map(|octets| hex(octets.as_slice()))));
        }
    };
    Some(compare(number(expectation), bit.map(u32::from)))
}

fn pdin(expectation: &Expectation, session: &Session<'_>) -> Option<Judged> {
    let setup = session.setup();
    if setup.pd_in == 0 || (expectation.value == Expected::Live && !session.serves(Pco::App)) {
        return None;
    }
    let expected = match &expectation.value {
        Expected::Live => hex(session.link().input.as_slice()),
        Expected::Octets(octets) => hex(octets),
        _ => hex(&vec![0; setup.pd_in]),
    };
    Some(compare(expected, session.answer().map(|view| hex(view.pd()))))
}

/// The octet of FS-PDin that is not filled.
fn padding(session: &Session<'_>) -> Option<Judged> {
    let input = session.profile.structure?.input;
    let (at, bits) = input.padding().filter(|_| input.octets() == session.setup().pd_in)?;
    let right = session.answer().filter(|view| view.signature_matches(session.setup().reading));
    let octet = right.and_then(|view| view.pd().get(at).copied());
    let observed = octet.map_or_else(|| "no SPDU".to_owned(), |octet| format!("octet {at} is {octet:02X}"));
    let met = octet.is_some_and(|octet| octet & bits == 0);
    Some((format!("padding bits {bits:02X} of octet {at} are 0"), observed, met))
}

/// Whether the declared structure is made of words of 16 bits.
fn structure(session: &Session<'_>) -> Option<Judged> {
    let (out, input) = session.profile.structure?.sizes();
    let observed = format!("{out} octets of FS-PDout, {input} of FS-PDin");
    Some(("an even number of octets each way".to_owned(), observed, out % 2 == 0 && input % 2 == 0))
}

fn image(expectation: &Expectation, before: &Before, session: &Session<'_>) -> Judged {
    let text = |image: &Option<Octets>| match image {
        Some(octets) if octets.as_slice().iter().any(|octet| *octet != 0) => hex(octets.as_slice()),
        _ => "all zero or none".to_owned(),
    };
    let observed = text(&session.link().image);
    match expectation.value {
        Expected::Unchanged => {
            let expected = text(&before.image);
            let met = expected == observed;
            (expected, observed, met)
        }
        Expected::Answer => {
            let reading = session.setup().reading;
            let met = session.answer().is_some_and(|view| view.signature_matches(reading));
            ("an SPDU with right signature".to_owned(), observed, met)
        }
        _ => {
            let met = observed == text(&None);
            (text(&None), observed, met)
        }
    }
}

fn service(expectation: &Expectation, before: &Before, session: &Session<'_>, tester: &Tester) -> Option<Judged> {
    if !session.serves(Pco::App) {
        return None;
    }
    let bit = |value: Option<bool>| value.map(u32::from);
    match expectation.key {
        Key::SetSdDc => return Some(compare(number(expectation), bit(session.link().app.set_sd_dc))),
        Key::ChFAckReqDc => return Some(compare(number(expectation), bit(session.link().app.ch_f_ack_req_dc))),
        _ => {}
    }
    if session.setup().pd_out == 0 {
        return None;
    }
    let safe = hex(&vec![0; session.setup().pd_out]);
    let observed = session.link().app.pdout_d.map(|octets| hex(octets.as_slice()));
    let expected = match &expectation.value {
        Expected::Live => hex(tester.pd.octets()),
        Expected::Unchanged => hex(before.pdout_d?.as_slice()),
        Expected::Octets(octets) => hex(octets),
        Expected::Withheld => {
            let stood = before.pdout_d.map_or(safe.clone(), |octets| hex(octets.as_slice()));
            let met = observed.as_ref().is_some_and(|octets| *octets == safe || *octets == stood);
            return Some((format!("{safe} or {stood}"), observed.unwrap_or_else(|| "not reported".to_owned()), met));
        }
        _ => safe,
    };
    Some(compare(expected, observed))
}

fn reply(expectation: &Expectation, session: &Session<'_>) -> Option<Judged> {
    let observed = session.replied();
    let expected = match &expectation.value {
        Expected::Written => "written".to_owned(),
        Expected::Refused => {
            let met = matches!(session.reply, Some(Reply::Refused(_)));
            return Some(("refused".to_owned(), observed, met));
        }
        Expected::Octets(octets) => hex(octets),
        Expected::Configured => hex(&session.profile.authenticity().to_octets()),
        Expected::Structure => return Some(declared_structure(session)),
        Expected::OtherTechnology => hex(&session.profile.technology.as_ref()?.other),
        Expected::Count(count) => {
            let met = matches!(&session.reply, Some(Reply::Value(octets)) if octets.len() == *count);
            return Some((format!("{count} octets read"), observed, met));
        }
        Expected::Declared(item) => {
            let octets = match &session.reply {
                Some(Reply::Value(octets)) => octets.as_slice(),
                _ => &[],
            };
            let (expected, met) = declared(*item, octets, session.profile.declaration.as_ref()?)?;
            return Some((expected, observed, met));
        }
        Expected::Range(field, least, most) => {
            let met = matches!(&session.reply, Some(Reply::Value(octets))
                if value(octets, *field).is_some_and(|value| (*least..=*most).contains(&value)));
            return Some((expectation.text.clone(), observed, met));
        }
        Expected::Contains(entry) => {
            let met = matches!(&session.reply, Some(Reply::Value(octets))
                if octets.chunks(entry.len()).any(|octets| octets == entry));
            return Some((expectation.text.clone(), observed, met));
        }
        Expected::Unlocked => {
            let met = match &session.reply {
                Some(Reply::Value(octets)) => octets.len() == 2 && octets.last().is_some_and(|octet| octet & 3 == 0),
                Some(Reply::Refused(_)) => true,
                _ => false,
            };
            return Some(("bits 0 and 1 are 0, or no such object".to_owned(), observed, met));
        }
        _ => format!("refused 0x{:04X}", number(expectation)),
    };
    let met = expected == observed;
    Some((expected, observed, met))
}

/// What the IODD declares of an object, and whether the octets read say the same. `None`: nothing is declared.
fn declared(item: Declared, octets: &[u8], declaration: &Declaration) -> Option<(String, bool)> {
    let value = match item {
        Declared::Protocol => {
            let (mode, io_struct_crc) = (declaration.mode?.code(), declaration.io_struct_crc?);
            let expected = format!(
                "01 {mode:02X} .. .. {} and six octets more, as the IODD declares",
                hex(&io_struct_crc.to_be_bytes())
            );
            let read = Protocol::fields(octets).ok();
            let met =
                read.is_some_and(|read| (read.version, read.mode, read.io_struct_crc) == (1, mode, io_struct_crc));
            return Some((expected, met));
        }
        Declared::ParamDescCrc => {
            let value = declaration.param_desc_crc?;
            match declaration.edition {
                Edition::V1_1 => u16::try_from(value).ok()?.to_be_bytes().to_vec(),
                Edition::Iec2022 => value.to_be_bytes().to_vec(),
            }
        }
        Declared::TimeToReady => declaration.time_to_ready?.to_be_bytes().to_vec(),
        Declared::MinShutDownTime => declaration.min_shut_down_time?.to_be_bytes().to_vec(),
        Declared::Wcdt => declaration.wcdt?.to_be_bytes().to_vec(),
        Declared::Ofdt => declaration.ofdt?.to_be_bytes().to_vec(),
    };
    Some((format!("{}, as the IODD declares", hex(&value)), value == octets))
}

/// The protocol record, which has to hold the FSP_IO_StructCRC of the declared structure.
fn declared_structure(session: &Session<'_>) -> Judged {
    let wanted = session.profile.structure.and_then(|structure| structure.signature(session.setup().mode));
    let told = match &session.reply {
        Some(Reply::Value(octets)) => Protocol::fields(octets).ok().map(|protocol| protocol.io_struct_crc),
        _ => None,
    };
    let text = |crc: u16| format!("FSP_IO_StructCRC {crc:04X}");
    let expected = wanted.map_or_else(|| "a structure that fits into the mode".to_owned(), text);
    (expected, told.map_or_else(|| session.replied(), text), wanted.is_some() && told == wanted)
}

/// The number that was read, or a field of the authenticity or protocol record that was.
fn value(octets: &[u8], field: Option<&'static RecordField>) -> Option<u32> {
    let octets = match field {
        None => octets,
        Some(field) => {
            let before = if octets.len() == Protocol::OCTETS { Authenticity::OCTETS } else { 0 };
            octets.get(field.octets.0.checked_sub(before)?..field.octets.1.checked_sub(before)?)?
        }
    };
    let few = (1..=4).contains(&octets.len());
    few.then(|| octets.iter().fold(0, |value, octet| value << 8 | u32::from(*octet)))
}

#[cfg(test)]
mod tests {
    use super::{reserved, value};
    use crate::case::model::RecordField;
    use fsct_adapters::Role;
    use fsct_protocol::Edition;
    use rstest::rstest;

    #[rstest]
    #[case(&[0x7F, 0xFF], None, Some(0x7FFF))]
    #[case(&[], None, None)]
    #[case(&[0; 5], None, None)]
    #[case(&[0, 0, 0, 0, 0, 0, 0, 0, 7, 0, 0], Some("FSP_Port"), Some(7))]
    #[case(&[0, 0, 0, 0, 0, 0, 1, 2, 3, 4, 0, 0], Some("FSP_TechParCRC"), Some(0x0102_0304))]
    #[case(&[0, 0, 0, 0, 0, 0, 1, 2, 3, 4, 0, 0], Some("FSP_Port"), None)]
    #[case(&[0, 1], Some("FSP_Port"), None)]
    fn numbers_are_read(#[case] octets: &[u8], #[case] field: Option<&str>, #[case] expected: Option<u32>) {
        let field = field.and_then(|name| RecordField::ALL.iter().find(|field| field.name == name));
        assert_eq!(value(octets, field), expected);
    }

    #[rstest]
    #[case(Role::Master, Edition::V1_1, 0xB003..=0xB006, false)]
    #[case(Role::Master, Edition::V1_1, 0xB007..=0xB008, true)]
    #[case(Role::Master, Edition::V1_1, 0xB009..=0xB009, false)]
    #[case(Role::Master, Edition::V1_1, 0xB00A..=0xB0FF, true)]
    #[case(Role::Master, Edition::V1_1, 0xB100..=0xB100, false)]
    #[case(Role::Master, Edition::Iec2022, 0x2003..=0x2003, false)]
    #[case(Role::Master, Edition::Iec2022, 0x2004..=0x2004, true)]
    #[case(Role::Master, Edition::Iec2022, 0x2005..=0x2006, false)]
    #[case(Role::Master, Edition::Iec2022, 0x2007..=0x2008, true)]
    #[case(Role::Master, Edition::Iec2022, 0x2009..=0x2009, false)]
    #[case(Role::Master, Edition::Iec2022, 0x200A..=0x20EF, true)]
    #[case(Role::Master, Edition::Iec2022, 0x20F0..=0x20F0, false)]
    #[case(Role::Master, Edition::Iec2022, 0x20F1..=0x20FF, true)]
    #[case(Role::Device, Edition::V1_1, 0xB000..=0xB009, false)]
    #[case(Role::Device, Edition::V1_1, 0xB00A..=0xB0FF, true)]
    #[case(Role::Device, Edition::Iec2022, 0xB000..=0xB00A, false)]
    #[case(Role::Device, Edition::Iec2022, 0xB00B..=0xB0FF, true)]
    fn reserved_codes_are_those_of_the_tables(
        #[case] role: Role,
        #[case] edition: Edition,
        #[case] codes: std::ops::RangeInclusive<u16>,
        #[case] wanted: bool,
    ) {
        assert!(codes.into_iter().all(|code| reserved(role, edition, code) == wanted));
    }
}
