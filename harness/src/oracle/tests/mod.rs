//! The oracle told exchange by exchange, as tables and charts read: what it takes, and what it refuses under which name.
//! No case stands beside it here, so an oracle that has gone blind shows.

mod config;
mod device;
mod form;
mod master;
mod ossde;
mod readings;
mod setup;
mod watchdog;

use super::{App, Mask, Mismatch, Oracle, Setup};
use fsct_adapters::{Octets, Role, Service};
use fsct_protocol::crc::Reading;
use fsct_protocol::spdu::{Control, InSpdu, OutSpdu, Pd, Port, Status};
use fsct_protocol::{Edition, ProtMode};
use rstest::rstest;

const CYCLE: u64 = 1_000_000;
const WATCHDOG: u64 = 20 * CYCLE;
const TICK: u64 = 100_000;
const UNCERTAINTY: u64 = 10_000;
const MARGIN: u64 = 2 * CYCLE;
const PDOUT: [u8; 2] = [0x12, 0x34];
const PDIN: [u8; 2] = [0x56, 0x78];

/// A bench on which nothing is tolerated.
fn strict(role: Role) -> Setup {
    Setup {
        role,
        edition: Edition::V1_1,
        mode: ProtMode::Crc16,
        pd_out: 2,
        pd_in: 2,
        port: Port::ONE,
        reading: Reading::Preset,
        cycle_ns: CYCLE,
        watchdog_ns: WATCHDOG,
        tick_ns: TICK,
        margin_ns: MARGIN,
        uncertainty_ns: UNCERTAINTY,
        latency: 0,
        scl_start_ns: 0,
        allowed: Mask::NONE,
        app: true,
    }
}

/// The same with these tolerances.
fn tolerant(role: Role, allowed: &[u8]) -> Setup {
    Setup { allowed: allowed.iter().fold(Mask::NONE, |mask, number| mask.with(*number)), ..strict(role) }
}

/// An SPDU of the FS-Master: MCount, setSD, ChFAckReq.
fn m(mcount: u8, set_sd: u8, ch_f_ack_req: u8, pd: [u8; 2]) -> Vec<u8> {
    let control = Control { mcount, set_sd: set_sd == 1, ch_f_ack_req: ch_f_ack_req == 1 };
    let spdu = OutSpdu { pd: Pd::new(&pd).expect("two octets"), port: Port::ONE, control };
    spdu.wire().emit(ProtMode::Crc16, Reading::Preset).octets().to_vec()
}

/// An SPDU of the FS-Device: DCount_i, SDset, DCommErr, DTimeout.
fn d((dcount_i, sd_set, d_comm_err, d_timeout): (u8, u8, u8, u8), pd: [u8; 2]) -> Vec<u8> {
    let status = Status { dcount_i, sd_set: sd_set == 1, d_comm_err: d_comm_err == 1, d_timeout: d_timeout == 1 };
    let spdu = InSpdu { pd: Pd::new(&pd).expect("two octets"), port: Port::ONE, status };
    spdu.wire().emit(ProtMode::Crc16, Reading::Preset).octets().to_vec()
}

/// The same SPDU hit by a disturbance.
fn hit(mut spdu: Vec<u8>) -> Vec<u8> {
    spdu[0] ^= 0x10;
    spdu
}

#[track_caller]
fn refused(verdict: Result<(), Mismatch>, kind: &str) -> Mismatch {
    let mismatch = verdict.expect_err("this must not be taken");
    assert_eq!(mismatch.kind, kind, "{mismatch:?}");
    mismatch
}

fn nothing() -> App {
    App::default()
}

/// The oracle of a link is that of the side the DUT is on, whatever it is told.
#[rstest]
#[case(Role::Device, Some(m(0, 0, 0, PDOUT)), d((7, 1, 0, 0), PDIN), Service::PdinD, 20)]
#[case(Role::Master, Some(d((7, 1, 0, 0), [0; 2])), m(1, 0, 0, PDIN), Service::PdoutM, 1)]
fn an_oracle_passes_on_what_it_is_told(
    #[case] role: Role,
    #[case] received: Option<Vec<u8>>,
    #[case] image: Vec<u8>,
    #[case] input: Service,
    #[case] first: u8,
) {
    let given = Octets::new(&PDIN).expect("two octets");
    let mut oracle = Oracle::new(tolerant(role, &[18]));
    assert_eq!((oracle.setup().role, oracle.state(), oracle.may_be_starting()), (role, None, false));
    oracle.power(true);
    refused(oracle.exchange(1, received.as_deref(), Some(&image), &nothing()), "idle");
    oracle.parameterized(1);
    assert!(oracle.may_be_starting() && oracle.state().is_some());
    oracle.input(input, &given);
    assert_eq!(oracle.exchange(2, received.as_deref(), Some(&image), &nothing()), Ok(()));
    assert_eq!((oracle.taken()[0], oracle.via()[0], oracle.may_be_starting()), ((first, 1), first, false));
    assert!(oracle.used().is_empty());
    let mut early = Oracle::new(tolerant(Role::Device, &[18]));
    early.power(true);
    early.parameterized(1);
    assert_eq!(early.exchange(2, None, Some(&d((7, 1, 0, 0), [0; 2])), &nothing()), Ok(()));
    assert_eq!(early.used(), Mask::NONE.with(18));
}
