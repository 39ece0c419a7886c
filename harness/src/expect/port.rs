//! Expectations that only an FS-Master knows: its ports and the results of its services.

use super::{Judged, number};
use crate::case::model::{ERRORS, Expectation, Expected, Key, Outcome, blocks};
use crate::portconfig::verify_record;
use crate::session::Session;
use crate::trace::hex;
use fsct_adapters::{Mode, SmiRequest, SmiResult};
use fsct_protocol::Edition;
use fsct_protocol::smi::{ArgBlock, FS_MASTER_ACCESS, FS_PORT_CONFIG_LIST, JOB_ERROR};

/// What the virtual FS-Device on the port has been asked and holds; `None` before one was connected.
pub fn of_specimen(expectation: &Expectation, session: &Session<'_>) -> Option<Judged> {
    let link = session.link();
    let memory = link.memory.as_ref()?;
    Some(match &expectation.value {
        Expected::Transfers(wanted) => {
            let met = memory.transfer().is_some_and(|transfer| wanted.contains(&transfer));
            (self::wanted(expectation), memory.told(), met)
        }
        value => {
            let wanted = match value {
                Expected::Unchanged => memory.records_before(),
                _ => verify_record(session.setup().edition, &link.configured).to_vec(),
            };
            let held = memory.records();
            (hex(&wanted), hex(&held), held == wanted)
        }
    })
}

/// What happened on the port since the step began.
pub fn of_port(expectation: &Expectation, session: &Session<'_>) -> Judged {
    let link = session.link();
    let compare = |expected: String, observed: String| {
        let met = expected == observed;
        (expected, observed, met)
    };
    match (expectation.key, &expectation.value) {
        (Key::Mode, Expected::Mode(mode)) => compare(mode.to_string(), link.mode.to_string()),
        (Key::PortPower, _) => compare(number(expectation).to_string(), u8::from(link.port_power).to_string()),
        (Key::Cq, _) => compare(number(expectation).to_string(), u8::from(link.lines.cq()).to_string()),
        (Key::Iq, _) => compare(number(expectation).to_string(), u8::from(link.lines.iq()).to_string()),
        (Key::WakeUp, _) => compare(number(expectation).to_string(), link.wake_ups.to_string()),
        (_, expected) => {
            let written: Vec<String> =
                link.records.iter().map(|(mode, data)| format!("{} in {mode}", hex(data))).collect();
            let observed = if written.is_empty() { "nothing written".to_owned() } else { written.join(", ") };
            let wanted = match expected {
                Expected::None => return ("nothing written".to_owned(), observed, link.records.is_empty()),
                Expected::Octets(octets) => octets.clone(),
                Expected::Right if link.mode != Mode::Operate && link.records.is_empty() => {
                    return ("no OPERATE without the record".to_owned(), format!("{observed}, {}", link.mode), true);
                }
                _ => verify_record(session.setup().edition, &link.configured).to_vec(),
            };
            let met = !link.records.is_empty()
                && link.records.iter().all(|(mode, data)| *data == wanted && *mode == Mode::Preoperate);
            (format!("{} in {}", hex(&wanted), Mode::Preoperate), observed, met)
        }
    }
}

/// The result of the latest SMI request.
pub fn of_result(expectation: &Expectation, session: &Session<'_>) -> Judged {
    let edition = session.setup().edition;
    let Some((request, Some(result))) = &session.smi else {
        return (wanted(expectation), "no result".to_owned(), false);
    };
    match (expectation.key, &expectation.value) {
        (Key::Result, Expected::Results(outcomes)) => {
            let back = (result.client_id, result.port) == (request.client_id, request.port);
            let observed = outcome(edition, result);
            let met = outcomes.iter().any(|outcome| is(edition, result, *outcome));
            let lost = if back { "" } else { ", with another ClientID or PortNumber than the request" };
            (wanted(expectation), format!("{observed}{lost}"), met && (back || edition == Edition::V1_1))
        }
        (Key::Reference, _) => {
            let expected = number(expectation);
            (
                format!("0x{expected:04X}"),
                format!("0x{:04X}", result.reference),
                u32::from(result.reference) == expected,
            )
        }
        (Key::Length, expected) => {
            let right = match expected {
                Expected::Right => result.octets.len() as u32,
                _ => number(expectation),
            };
            (right.to_string(), result.length.to_string(), u32::from(result.length) == right)
        }
        (Key::Block, Expected::Octets(octets)) => {
            (hex(octets), hex(&result.octets), octets.as_slice() == result.octets.as_slice())
        }
        (Key::Block, Expected::Snapshot) => snapshot(session, result),
        (Key::Block, Expected::None) => {
            let void = result.octets.is_empty() || result.octets == [0xFF, 0xF0];
            ("no content".to_owned(), hex(&result.octets), void)
        }
        (Key::Block, _) => {
            let configured = &session.link().configured;
            (hex(configured), hex(&result.octets), *configured == result.octets)
        }
        (Key::Field(name), expected) => {
            let block = block(edition, request, result);
            let field = block.and_then(|block| block.field(name));
            let seen = field.and_then(|field| field.value(edition, &result.octets));
            if let Expected::Not(other) = expected {
                let text = seen.map_or_else(|| "not there".to_owned(), |value| format!("0x{value:X}"));
                return (format!("not 0x{other:X}"), text, seen.is_some_and(|seen| seen != *other));
            }
            let right = match expected {
                Expected::Configured => {
                    FS_PORT_CONFIG_LIST.field(name).and_then(|field| field.value(edition, &session.link().configured))
                }
                _ => Some(number(expectation)),
            };
            let text =
                |value: Option<u32>| value.map_or_else(|| "not there".to_owned(), |value| format!("0x{value:X}"));
            (text(right), text(seen), right.is_some() && seen == right)
        }
        _ => (wanted(expectation), "nothing of the kind".to_owned(), false),
    }
}

/// FSPDInOut of what stands in the images of both directions (Table 25); PQI and OE are for the base standard to judge.
fn snapshot(session: &Session<'_>, result: &SmiResult) -> Judged {
    let octets =
        |octets: &Option<fsct_adapters::Octets>| octets.map_or_else(Vec::new, |octets| octets.as_slice().to_vec());
    let (input, output) = (octets(&session.link().sent), octets(&session.link().image));
    let mut expected = vec![0x11, 0x03];
    expected.extend(result.octets.get(2..4).unwrap_or(&[0, 0]));
    expected.push(input.len() as u8);
    expected.extend(&input);
    expected.push(output.len() as u8);
    expected.extend(&output);
    (hex(&expected), hex(&result.octets), expected == result.octets)
}

fn wanted(expectation: &Expectation) -> String {
    expectation.text.clone()
}

/// The kind of block in a result.
fn block(edition: Edition, request: &SmiRequest, result: &SmiResult) -> Option<&'static ArgBlock> {
    if !result.positive {
        return Some(&JOB_ERROR);
    }
    // In v1.1 the block that comes back has the name, and the authenticity that iec2022 gave a block of its own.
    match (edition, blocks(request.service).1) {
        (Edition::V1_1, Some(block)) if block.name == "FSCPAuthenticity" => Some(&FS_MASTER_ACCESS),
        (_, block) => block,
    }
}

/// ErrorType of a JobError, or ErrorInfo of v1.1.
fn error(edition: Edition, result: &SmiResult) -> Option<u16> {
    match edition {
        Edition::V1_1 => result.octets.first_chunk().map(|octets| u16::from_be_bytes(*octets)),
        Edition::Iec2022 => {
            JOB_ERROR.field("ErrorType")?.value(edition, &result.octets).and_then(|error| u16::try_from(error).ok())
        }
    }
}

fn is(edition: Edition, result: &SmiResult, outcome: Outcome) -> bool {
    match outcome {
        Outcome::Positive => result.positive,
        Outcome::Negative => !result.positive,
        Outcome::Error(wanted) => !result.positive && error(edition, result) == Some(wanted),
    }
}

/// A result in words.
pub fn outcome(edition: Edition, result: &SmiResult) -> String {
    match (result.positive, error(edition, result)) {
        (true, _) => format!("positive, {}", hex(&result.octets)),
        (false, None) => "negative, without an error".to_owned(),
        (false, Some(error)) => {
            let name = ERRORS.iter().find(|(number, _)| *number == error).map_or("", |entry| entry.1);
            format!("negative, 0x{error:04X} {name}")
        }
    }
}
