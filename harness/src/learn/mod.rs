//! A DUT as the teacher of [`fsct_observed::learn`]: every word from a fresh start, waiting for the first SPDU, and nothing judged.
//!
//! The tester chooses counters by what was seen last. It gives new process data with each input, so that a new SPDU shows even where
//! its flags are those of the one before; what is left alone is seen by nothing new.

mod device;
pub mod document;
mod hand;
mod master;

use crate::campaign::{Bench, setup};
use crate::case::model::Step;
use crate::engine::{Engine, Judging};
use crate::library::Library;
use crate::oracle::{Mask, Setup};
use crate::profile::Profile;
use crate::session::{Session, Stop};
use crate::tester::Tester;
use fsct_adapters::{Description, Mode, Offer, Pco, Role, Variant};
use fsct_observed::learn::Teacher;
use fsct_observed::{Seen, Side};
use fsct_protocol::{Edition, ProtMode};
use fsct_reports::record::{Execution, Verdict};
use hand::Hand;
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::SeedableRng;
use std::sync::atomic::AtomicBool;

/// The start condition every word begins from.
const START: &str = "waiting";
/// How often a word is tried on a real clock on which exchanges come late.
const TRIES: usize = 50;
/// Octets of process data each way, where the DUT leaves the choice.
const PD: u8 = 2;

/// Why a word could not be asked to its end.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Trouble {
    /// The DUT gave no usable answer.
    #[error("{0}")]
    Dut(String),
    /// The DUT does not come to wait for a first SPDU.
    #[error("the DUT does not reach the start condition `{START}`: {0}")]
    Start(String),
    /// A row of inputs that are left alone takes longer than the watchdog.
    #[error(
        "an FSP_Watchdog of {0} ms is too short for the inputs a word holds in a row: raise FSP_Watchdog_ms in the profile"
    )]
    Short(u16),
    /// Exchanges came late, however often it was tried.
    #[error("exchanges come more than half a MasterCycleTime late: raise MasterCycleTime_us in the profile")]
    Late,
    /// The user asked to stop.
    #[error("stopped by the user")]
    Interrupted,
}

impl From<Stop> for Trouble {
    fn from(stop: Stop) -> Trouble {
        match stop {
            Stop::Dut(error) => Trouble::Dut(error.to_string()),
            Stop::Unserved(what) => Trouble::Dut(what),
            Stop::Mismatch(found) => Trouble::Dut(found.observed),
            Stop::Slipped(..) => Trouble::Late,
            Stop::Interrupted => Trouble::Interrupted,
        }
    }
}

/// The side a DUT is on.
pub const fn side(role: Role) -> Side {
    match role {
        Role::Device => Side::Device,
        Role::Master => Side::Master,
    }
}

/// The variant of a DUT to learn: of this edition and mode, where one is asked for, with process data both ways.
///
/// # Errors
/// One sentence for the user.
pub fn variant(
    description: &Description,
    profile: &Profile,
    edition: Option<Edition>,
    mode: Option<ProtMode>,
) -> Result<Variant, String> {
    if let Some(missing) = [Pco::Power, Pco::Link, Pco::App].into_iter().find(|pco| !description.pcos.contains(pco)) {
        return Err(format!(
            "the DUT does not serve `{}`; a machine is learnt by restarts, on the link and by what the application is given",
            missing.name()
        ));
    }
    let declared = profile.structure.map(|structure| structure.sizes());
    let fits = |offer: &&Offer| {
        edition.is_none_or(|edition| edition == offer.edition) && mode.is_none_or(|mode| mode == offer.mode)
    };
    let sized = |offer: &Offer| {
        let (out, input) = declared.map_or((PD, PD), |(out, input)| (out as u8, input as u8));
        let size = |wanted: u8, (least, most): (u8, u8)| wanted.clamp(least, most.max(least));
        let (pd_out, pd_in) = (size(out, offer.pd_out), size(input, offer.pd_in));
        (pd_out > 0 && pd_in > 0).then_some(Variant { edition: offer.edition, mode: offer.mode, pd_out, pd_in })
    };
    // The later edition first.
    let mut offers: Vec<&Offer> = description.offers.iter().filter(fits).collect();
    offers.sort_by_key(|offer| (offer.edition != Edition::Iec2022, offer.mode != ProtMode::Crc16));
    offers.into_iter().find_map(sized).ok_or_else(|| {
        "the DUT offers nothing of the edition and mode asked for with process data both ways".to_owned()
    })
}

/// A DUT that is asked.
pub struct Lab<'l> {
    library: &'l Library,
    profile: &'l Profile,
    interrupted: &'l AtomicBool,
    bench: &'l mut Bench,
    variant: Variant,
    seed: u64,
    start: Vec<Step>,
}

impl<'l> Lab<'l> {
    /// Ready to ask it as this variant.
    ///
    /// # Errors
    /// [`Trouble`] when there is nothing to start it by.
    pub fn new(
        library: &'l Library,
        profile: &'l Profile,
        interrupted: &'l AtomicBool,
        bench: &'l mut Bench,
        variant: Variant,
        seed: u64,
    ) -> Result<Lab<'l>, Trouble> {
        let mut problems = Vec::new();
        let mut start = library.start_steps(profile.role, START, &mut problems);
        if start.is_empty() || !problems.is_empty() {
            return Err(Trouble::Start("there is no sound start condition of this name".to_owned()));
        }
        // What is learnt is not judged, neither is the way to it.
        for step in &mut start {
            step.expect.clear();
            step.remark.clear();
            step.measure.clear();
        }
        Ok(Lab { library, profile, interrupted, bench, variant, seed, start })
    }

    /// One try; `None` where exchanges came late.
    fn once(&mut self, word: &[usize]) -> Result<Option<Vec<Seen>>, Trouble> {
        let Lab { profile, variant, seed, .. } = *self;
        // A DUT that is configured forgets everything, an FS-Master the pause its supply needs between two starts as well.
        self.bench.configure(variant).map_err(|error| Trouble::Dut(error.to_string()))?;
        let Bench { dut, description, .. } = &mut *self.bench;
        let setups: Vec<Setup> =
            (0..description.ports).map_while(|index| setup(profile, Mask::NONE, description, variant, index)).collect();
        if setups.is_empty() {
            return Err(Trouble::Dut("the DUT has no ports".to_owned()));
        }
        // The same for every word: one that begins like another gives the same octets.
        let rng = |port: u64| Pcg64Mcg::seed_from_u64(seed ^ port);
        let testers = (0..).zip(&setups).map(|(index, setup)| Tester::new(setup, rng(index))).collect();
        let mut session = Session::new(dut.as_mut(), description, profile, setups, self.interrupted);
        session.links.iter_mut().for_each(|link| link.case_alone = true);
        let judging =
            Judging { limits: &self.library.limits.limits, clauses: String::new(), demands: false, shown: Mask::NONE };
        let (outcome, mut testers) = Engine::new(&mut session, testers, judging).reach(&self.start, START);
        let observed = outcome.reasons.first().map_or("no answer", |reason| reason.observed.as_str());
        match outcome.execution {
            Execution::Ok if outcome.verdict <= Verdict::Remark => {}
            Execution::Ok => return Err(Trouble::Start(observed.to_owned())),
            Execution::Aborted => return Err(Trouble::Interrupted),
            _ => return Err(Trouble::Dut(observed.to_owned())),
        }
        if profile.role == Role::Master && session.mode() != Mode::Operate {
            return Err(Trouble::Start("its port is not in OPERATE".to_owned()));
        }
        if profile.scl_start_ms > 0 {
            session.pass(profile.scl_start_ms * 1_000_000)?;
        }
        session.slipped = false;
        let Some(tester) = testers.first_mut() else { return Ok(None) };
        let hand = Hand::new(&mut session, tester);
        let told = match profile.role {
            Role::Device => device::told(hand, word),
            Role::Master => master::told(hand, word),
        };
        match told {
            // Where an exchange came late, what followed says nothing.
            Ok(_) | Err(Trouble::Short(_)) if session.slipped => Ok(None),
            told => told.map(Some),
        }
    }
}

impl Teacher for Lab<'_> {
    type Output = Seen;
    type Error = Trouble;

    fn ask(&mut self, word: &[usize]) -> Result<Vec<Seen>, Trouble> {
        for _ in 0..TRIES {
            if let Some(seen) = self.once(word)? {
                return Ok(seen);
            }
        }
        Err(Trouble::Late)
    }
}
