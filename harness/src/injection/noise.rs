//! A binary symmetric channel in front of the DUT: each bit of an SPDU wrong with the same probability (Annex D).
//!
//! The signature alone has to decide. So what is sent is made for its noise: drawn first, it turns PortNum and the control or status
//! octet of what is sent into those the DUT expects, and a corrupted SPDU that carries a right signature again is taken. How often that
//! happens is Rp. An FS-Device shows an error as DCommErr, which is clear in the answer before because a good SPDU lies between two
//! noisy ones (T29); an FS-Master in state 7 asks for the acknowledgment when the answer was good (T13) and no longer when not (T12).

use super::corruption::Mask;
use super::finding::{Finding, Halt};
use super::stage::Target;
use crate::campaign::Bench;
use crate::oracle::Setup;
use crate::session::{Item, Session};
use crate::tester::Tester;
use fsct_adapters::{Octets, Role, Variant};
use fsct_protocol::spdu::{Control, MAX_PD, MAX_SPDU, Pd, Status, View, Wire, inv3, succ};
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::{Rng, SeedableRng};

/// Noisy SPDUs in one batch.
const BATCH: u64 = 256;

/// How noisy the channel is, and for how long.
#[derive(Copy, Clone, Debug, PartialEq)]
pub struct Noise {
    /// Probability that a bit is wrong, 0 to 0.5.
    pub p: f64,
    /// SPDUs to send.
    pub spdus: u64,
    /// Seed of the noise and the data.
    pub seed: u64,
}

/// What became of the SPDUs.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq)]
pub struct Tried {
    /// SPDUs sent, those without a wrong bit included.
    pub spdus: u64,
    /// Those with at least one wrong bit.
    pub corrupted: u64,
    /// Of these, how many the DUT took for good.
    pub undetected: u64,
    /// Exchanges.
    pub exchanges: u64,
}

/// One noisy SPDU and the place of its last copy among the items of a batch.
struct Trial {
    item: usize,
    corrupted: bool,
    /// The signature is right, whatever the noise did.
    right: bool,
}

/// Sends the SPDUs to the DUT in operation. `told` hears how many are done; what it answers is whether to go on.
///
/// # Errors
/// [`Halt`]: a failure where the DUT takes what has no right signature, or the other way round; or it was not reached.
pub fn sweep(
    target: &Target<'_>,
    bench: &mut Bench,
    variant: Variant,
    noise: Noise,
    mut told: impl FnMut(u64) -> bool,
) -> Result<Tried, Halt> {
    let work = |session: &mut Session<'_>, tester: &mut Tester| {
        let setup = session.setup().clone();
        let mut source = Source::new(&setup, session, tester, noise);
        let mut tried = Tried::default();
        if setup.role == Role::Master {
            source.fault();
        }
        while tried.spdus < noise.spdus {
            let trials: Vec<Trial> = (0..BATCH.min(noise.spdus - tried.spdus)).map(|_| source.trial()).collect();
            batch(session, &setup, &source.items, &trials, &mut tried)?;
            source.items.clear();
            if !told(tried.spdus) {
                return Err(Halt::Interrupted);
            }
        }
        Ok(tried)
    };
    target.operate(bench, variant, noise.seed, work, |_| {})?
}

fn batch(
    session: &mut Session<'_>,
    setup: &Setup,
    items: &[Item],
    trials: &[Trial],
    tried: &mut Tried,
) -> Result<(), Halt> {
    let mut waiting = trials.iter().peekable();
    let mut wrong = None;
    session.slipped = false;
    session.carry_out(items, |index, link| {
        tried.exchanges += 1;
        let Some(trial) = waiting.next_if(|trial| trial.item == index) else { return };
        let taken = link.answer().is_some_and(|view| match setup.role {
            Role::Device => !view.status().d_comm_err,
            Role::Master => view.control().ch_f_ack_req,
        });
        tried.spdus += 1;
        tried.corrupted += u64::from(trial.corrupted);
        tried.undetected += u64::from(trial.corrupted && taken);
        if taken != trial.right && wrong.is_none() {
            wrong = Some((tried.spdus, taken));
        }
    })?;
    match wrong {
        Some(_) if session.slipped => Err(Halt::slipped("a noisy SPDU was not answered as its signature asks")),
        Some((number, taken)) => Err(Halt::Failure(Box::new(misjudged(setup.role, number, taken)))),
        None => Ok(()),
    }
}

fn misjudged(role: Role, number: u64, taken: bool) -> Finding {
    let (clause, right, wrong) = match role {
        Role::Device => ("11.5.3 Table 40 T25, T29", "DCommErr 0", "DCommErr 1"),
        Role::Master => ("11.5.2 Table 38 T12, T13", "ChFAckReq 1", "ChFAckReq 0"),
    };
    let (expected, observed) = if taken { (wrong, right) } else { (right, wrong) };
    let signature = if taken { "a wrong" } else { "a right" };
    Finding {
        kind: "injection/noise".to_owned(),
        clause: clause.to_owned(),
        expected: format!("{expected} behind noisy SPDU {number}, which carries {signature} signature"),
        observed: observed.to_owned(),
    }
}

/// Makes the SPDUs.
struct Source<'s> {
    setup: &'s Setup,
    noise: Noise,
    rng: Pcg64Mcg,
    copies: usize,
    items: Vec<Item>,
    /// FS-Device: MCount sent last. FS-Master: DCount_i sent last.
    count: u8,
}

impl<'s> Source<'s> {
    fn new(setup: &'s Setup, session: &Session<'_>, tester: &Tester, noise: Noise) -> Source<'s> {
        Source {
            setup,
            noise,
            rng: Pcg64Mcg::seed_from_u64(noise.seed),
            copies: session.profile.answer_latency as usize + 1,
            items: Vec::new(),
            count: tester.count.unwrap_or(0),
        }
    }

    /// A noisy SPDU, and for an FS-Device a good one behind it.
    fn trial(&mut self) -> Trial {
        let octets = self.setup.mode.spdu_octets(self.setup.sent_pd());
        let mask = self.draw(octets);
        let (item, right) = self.send(&mask);
        if self.setup.role == Role::Device {
            self.send(&[0; MAX_SPDU]);
        }
        Trial { item, corrupted: mask != [0; MAX_SPDU], right }
    }

    /// An SPDU with a wrong signature, so that an FS-Master waits for the acknowledgment.
    fn fault(&mut self) {
        let mut mask = [0; MAX_SPDU];
        mask[self.setup.mode.spdu_octets(self.setup.sent_pd()) - 1] = 1;
        self.send(&mask);
    }

    /// The next SPDU such that `mask` gives it the PortNum, counter and flags the DUT expects: the place of its last copy, and
    /// whether the signature that arrives is right.
    fn send(&mut self, mask: &Mask) -> (usize, bool) {
        let pd = self.setup.sent_pd();
        let octet = match self.setup.role {
            Role::Device => {
                self.count = succ(self.count);
                Control { mcount: self.count, set_sd: false, ch_f_ack_req: false }.to_octet()
            }
            Role::Master => {
                self.count = inv3(succ(inv3(self.count)));
                Status { dcount_i: self.count, ..Status::default() }.to_octet()
            }
        };
        let wire = Wire {
            pd: self.data(pd),
            port_num: self.setup.sent_port() ^ mask[pd],
            octet: octet ^ mask[pd + 1],
            signature: None,
        };
        let mut arriving = wire.emit(self.setup.mode, self.setup.reading);
        arriving.octets_mut().iter_mut().zip(mask).for_each(|(octet, mask)| *octet ^= mask);
        let view = View::new(arriving.octets(), self.setup.mode, pd);
        let right = view.is_ok_and(|view| view.signature_matches(self.setup.reading));
        let octets = Octets::new(arriving.octets()).unwrap_or_default();
        (0..self.copies).for_each(|_| self.items.push(Item::Exchange(octets)));
        (self.items.len() - 1, right)
    }

    fn data(&mut self, pd: usize) -> Pd {
        let mut octets = [0; MAX_PD];
        octets.chunks_mut(8).take(pd.div_ceil(8)).for_each(|chunk| {
            let drawn = self.rng.next_u64().to_be_bytes();
            chunk.iter_mut().zip(drawn).for_each(|(octet, drawn)| *octet = drawn);
        });
        Pd::new(&octets[..pd]).unwrap_or(Pd::safe(pd))
    }

    fn draw(&mut self, octets: usize) -> Mask {
        let below = (self.noise.p * 2f64.powi(32)) as u64;
        let mut mask = [0; MAX_SPDU];
        for octet in &mut mask[..octets] {
            for _ in 0..4 {
                let drawn = self.rng.next_u64();
                let wrong = |half: u64| u8::from(half < below);
                *octet = *octet << 2 | wrong(drawn >> 32) << 1 | wrong(drawn & 0xFFFF_FFFF);
            }
        }
        mask
    }
}
