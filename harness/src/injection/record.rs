//! Every corruption of FSP_VerifyRecord with so many bits inverted, each at a start-up of its own: none may start the SCL.
//!
//! The FS-Device is armed (all checks are in force, Table G.1). Each start-up is a power cycle, the falsified record and one
//! SPDU; the oracle, which was told of no parameterization, finds any answer. The right record is tried first and last, so that
//! a DUT that never starts passes nothing.

use super::corruption::{Corruptions, Mask};
use super::finding::{Finding, Halt};
use super::stage::Target;
use crate::campaign::Bench;
use crate::case::model::{Parameterize, Sent};
use crate::parameterize;
use crate::session::{Reply, Session};
use crate::tester::Tester;
use fsct_adapters::{Octets, Stimulus, Variant};
use fsct_protocol::fsp::{INDEX_PROTOCOL, INDEX_VERIFY, Protocol};
use fsct_protocol::spdu::{Control, OutSpdu, Pd};

/// How far it has come.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq)]
pub struct Tried {
    /// Falsified records written.
    pub records: u64,
    /// Of these, how many were refused instead of taken with an Event.
    pub refused: u64,
}

/// A falsified record that started the SCL, or a right one that did not.
#[derive(Clone, Debug)]
pub struct Started {
    /// The record as it was written.
    pub record: Vec<u8>,
    /// What was found.
    pub finding: Finding,
}

/// Writes the records; stops at the first that starts the SCL. `told` hears how many are done; what it answers is whether to
/// go on.
///
/// # Errors
/// [`Halt`] when the DUT did not come to operation, cannot be armed, or was lost.
pub fn sweep(
    target: &Target<'_>,
    bench: &mut Bench,
    variant: Variant,
    corruptions: Corruptions,
    seed: u64,
    mut told: impl FnMut(u64) -> bool,
) -> Result<(Tried, Option<Started>), Halt> {
    let work = |session: &mut Session<'_>, _: &mut Tester| {
        let right = arm(session)?;
        let mut tried = Tried::default();
        if let Some(found) = trial(session, &right, None)? {
            return Ok((tried, Some(found)));
        }
        for mask in corruptions {
            let found = trial(session, &right, Some(&mask))?;
            tried.records += 1;
            tried.refused += u64::from(matches!(session.reply, Some(Reply::Refused(_))));
            if found.is_some() {
                return Ok((tried, found));
            }
            if !told(tried.records) {
                return Err(Halt::Interrupted);
            }
        }
        let found = trial(session, &right, None)?;
        Ok((tried, found))
    };
    target.operate(bench, variant, seed, work, |_| {})?
}

/// Writes the blocks of an armed system; the record that belongs to them.
fn arm(session: &mut Session<'_>) -> Result<Vec<u8>, Halt> {
    session.power(false)?;
    session.power(true)?;
    session.acyclic(Stimulus::Read { index: INDEX_PROTOCOL, subindex: 0 })?;
    let io_struct_crc = match &session.reply {
        Some(Reply::Value(data)) => Protocol::fields(data).ok().map(|protocol| protocol.io_struct_crc),
        _ => None,
    };
    let Some(io_struct_crc) = io_struct_crc else {
        return Err(Halt::Bench("the protocol record 0x4201 could not be read".to_owned()));
    };
    let asked = Parameterize { record: Sent::Written, armed: true, ..Parameterize::default() };
    let mut right = Vec::new();
    for (index, data) in parameterize::records(session.profile, &asked, session.setup().mode, io_struct_crc) {
        if index == INDEX_VERIFY {
            right = data;
            continue;
        }
        session.acyclic(Stimulus::Write { index, subindex: 0, data })?;
        if session.reply != Some(Reply::Written) {
            return Err(Halt::Bench(format!("record 0x{index:04X} was not written: {}", session.replied())));
        }
    }
    Ok(right)
}

/// One start-up with the record falsified so, or with the right one.
fn trial(session: &mut Session<'_>, right: &[u8], mask: Option<&Mask>) -> Result<Option<Started>, Halt> {
    let mut record = right.to_vec();
    mask.into_iter().flatten().zip(&mut record).for_each(|(bits, octet)| *octet ^= bits);
    session.power(false)?;
    session.power(true)?;
    session.acyclic(Stimulus::Write { index: INDEX_VERIFY, subindex: 0, data: record.clone() })?;
    if mask.is_none() {
        let now = session.now;
        session.link_mut().oracle.parameterized(now);
    }
    let setup = session.setup().clone();
    let (pd, control) = (Pd::safe(setup.pd_out), Control { mcount: 0, set_sd: true, ch_f_ack_req: false });
    let first = OutSpdu { pd, port: setup.port, control }.wire().emit(setup.mode, setup.reading);
    let profile = session.profile;
    let starting = profile.scl_start_ms * 1_000_000 / profile.master_cycle_time_ns;
    for _ in 0..=profile.answer_latency + starting {
        match session.exchange(Octets::new(first.octets())).map_err(Halt::from) {
            Ok(()) => {}
            Err(Halt::Failure(finding)) => return Ok(Some(Started { record, finding: *finding })),
            Err(halt) => return Err(halt),
        }
    }
    let silent = session.answer().is_none();
    let finding = (mask.is_none() && silent).then(|| Finding {
        kind: "injection/record".to_owned(),
        clause: "11.5.7, 9.1.1".to_owned(),
        expected: "an SPDU in answer to the right FSP_VerifyRecord".to_owned(),
        observed: "no SPDU of the SCL".to_owned(),
    });
    Ok(finding.map(|finding| Started { record, finding }))
}
