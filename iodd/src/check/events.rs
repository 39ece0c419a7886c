//! IODD-50 to IODD-53: the Events of the safety communication layer.

use super::{Check, quoted};
use fsct_protocol::Edition;

/// The Events in the order of their codes, from 45056 (0xB000); the last one is of iec2022 alone. The ends of their text ids.
const EVENTS: [&str; 11] = [
    "TransmissionError_CRCSignature",
    "TransmissionError_Counter",
    "TransmissionError_Timeout",
    "UnexpectedAuthenticationCode",
    "UnexpectedAuthenticationPort",
    "Incorrect_AuthentCRC",
    "Incorrect_ProtParCRC",
    "Incorrect_TechParCRC",
    "Incorrect_IO_StructCRC",
    "WatchdogTimeOutOfSpec",
    "NoFSVerifyRecord",
];
const FIRST: u64 = 0xB000;
const LAST: u64 = 0xB0FF;

/// The text ids of the profile, `TN_` or `TD_` before them.
pub(super) fn texts() -> impl Iterator<Item = String> {
    EVENTS.iter().flat_map(|name| [format!("TN_EV_FSP_{name}"), format!("TD_EV_FSP_{name}")])
}

pub(super) fn check(check: &mut Check<'_, '_>) {
    let iodd = check.iodd;
    let known = if check.is(Edition::V1_1) { EVENTS.len() - 1 } else { EVENTS.len() };
    let events = EVENTS.iter().take(known);
    for (code, name) in (FIRST..).zip(events) {
        let Some(event) = iodd.events.iter().find(|event| event.code == Some(code)) else {
            check.broken("IODD-50", iodd.events_at, format!("no Event {code}"), format!("Event {code}, {name}"));
            continue;
        };
        let found = format!("Event {code} is {}", quoted(event.kind));
        match (code - FIRST, event.kind) {
            (0 | 1, "Warning") | (2.., "Error") => {}
            (0 | 1, "Notification") => {
                check.doubtful("IODD-51", event.at, found, "`Warning`; Table B.1 alone says Notification");
            }
            (0 | 1, _) => check.broken("IODD-51", event.at, found, "`Warning`"),
            _ => check.broken("IODD-51", event.at, found, "`Error`"),
        }
        let ids = [
            (event.name, format!("TN_EV_FSP_{name}")),
            (event.description.unwrap_or_default(), format!("TD_EV_FSP_{name}")),
        ];
        for (id, wanted) in ids {
            if id != wanted {
                check.broken("IODD-52", event.at, format!("Event {code}: text {}", quoted(id)), quoted(&wanted));
            }
        }
    }
    for event in &iodd.events {
        let Some(code) = event.code.filter(|code| (FIRST + known as u64..=LAST).contains(code)) else { continue };
        check.broken("IODD-53", event.at, format!("Event {code}"), "no reserved code");
    }
}
