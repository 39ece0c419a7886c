//! Every corruption of one SPDU length, each sent to the DUT in regular operation.
//!
//! What follows a corruption is known beforehand, so hundreds of them go out in one batch: the falsified SPDU, then the
//! shortest conformant sequence that brings operation back. An FS-Device needs five good SPDUs for it (three SD cycles, T28,
//! T22), the first with MCount 0 unless that is what the falsified one carried: it is good after any other. An FS-Master
//! needs two good answers with an acknowledgment between them (T13, T11).

use super::action::{Action, Script};
use super::corruption::{Corruptions, Mask, bits};
use super::finding::{Finding, Halt};
use super::stage::{Stage, Tally, Target};
use crate::campaign::Bench;
use crate::link::Link;
use crate::oracle::Setup;
use crate::session::{Item, Session};
use crate::tester::Tester;
use fsct_adapters::{Octets, Role, Service, Variant};
use fsct_protocol::spdu::{Control, InSpdu, OutSpdu, Pd, Status, View, inv3, succ};
use fsct_reports::campaign::Counts;

/// Corruptions in one batch.
const BATCH: usize = 256;

/// What came of one kind of corruption at one length.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq)]
pub struct Outcome {
    /// Corruptions and what became of them; `valid`: a corrupted SPDU that carries the right signature again is not sent.
    pub counts: Counts,
    /// Exchanges they took.
    pub exchanges: u64,
}

/// A corruption that was not detected.
#[derive(Clone, Debug)]
pub struct Undetected {
    /// The SPDU as the DUT received it.
    pub octets: Octets,
    /// The list that shows it: the corruption, and those before it where it needs them.
    pub script: Script,
    /// What was found.
    pub finding: Finding,
}

/// The corruptions of one kind on their way through a DUT.
pub struct Sweep<'s> {
    target: &'s Target<'s>,
    variant: Variant,
    seed: u64,
    corruptions: std::iter::Peekable<Corruptions>,
    /// Taken from `corruptions`, not done yet.
    queue: Vec<Mask>,
    /// Where the sweep stands.
    pub outcome: Outcome,
}

/// What the DUT has to do with one corruption of a batch.
struct Segment {
    mask: Mask,
    bad: Octets,
    /// The last copy of the falsified SPDU, and the last exchange of the return to operation.
    reaction: usize,
    restored: usize,
    /// The counter is that of the SPDU before: the DUT leaves it unprocessed (A29).
    dropped: bool,
    /// What the DUT gives its application before the falsified SPDU, and once operation is back.
    before: Pd,
    after: Pd,
    reacted: bool,
    operates: bool,
}

impl<'s> Sweep<'s> {
    /// Ready to begin.
    pub fn new(target: &'s Target<'s>, variant: Variant, corruptions: Corruptions, seed: u64) -> Sweep<'s> {
        let corruptions = corruptions.peekable();
        Sweep { target, variant, seed, corruptions, queue: Vec::new(), outcome: Outcome::default() }
    }

    /// Whether every corruption has been sent.
    pub fn is_done(&mut self) -> bool {
        self.queue.is_empty() && self.corruptions.peek().is_none()
    }

    /// Goes on with a DUT that is switched on for it, up to the end or the first corruption that is not detected; that one
    /// counts as done. `told` hears how many are done; what it answers is whether to go on.
    ///
    /// # Errors
    /// [`Halt`] when the DUT did not come to operation or was lost. A failure outside of a corruption is one too.
    pub fn run(&mut self, bench: &mut Bench, mut told: impl FnMut(u64) -> bool) -> Result<Option<Undetected>, Halt> {
        let (target, variant, seed) = (self.target, self.variant, self.seed);
        target.operate(
            bench,
            variant,
            seed,
            |session, tester| {
                while !self.is_done() {
                    if let Some(undetected) = self.batch(session, tester)? {
                        return Ok(Some(undetected));
                    }
                    if !told(self.outcome.counts.injected) {
                        return Err(Halt::Interrupted);
                    }
                }
                Ok(None)
            },
            |_| {},
        )?
    }

    fn batch(&mut self, session: &mut Session<'_>, tester: &mut Tester) -> Result<Option<Undetected>, Halt> {
        let missing = BATCH - self.queue.len().min(BATCH);
        self.queue.extend(self.corruptions.by_ref().take(missing));
        let setup = session.setup().clone();
        let mut writer = Writer::new(&setup, session, tester);
        let mut segments = Vec::with_capacity(self.queue.len());
        for mask in &self.queue {
            match writer.segment(mask) {
                Some(segment) => segments.push(segment),
                None => {
                    self.outcome.counts.injected += 1;
                    self.outcome.counts.valid += 1;
                }
            }
        }
        let (items, next) = (writer.items, writer.count);
        let mut current = 0;
        session.slipped = false;
        let went = session.carry_out(&items, |index, link| {
            self.outcome.exchanges += 1;
            let Some(segment) = segments.get_mut(current) else { return };
            if index == segment.reaction {
                segment.reacted = segment.is_reaction(&setup, link);
            }
            if index == segment.restored {
                segment.operates = segment.is_operation(&setup, link);
                // Behind one that has not come back nothing counts.
                current = if segment.operates { current + 1 } else { usize::MAX };
            }
        });
        let done = segments.iter().take_while(|segment| segment.operates).count();
        let counts = &mut self.outcome.counts;
        for segment in &segments[..done] {
            counts.injected += 1;
            match segment {
                Segment { reacted: false, .. } => counts.failed += 1,
                Segment { dropped: true, .. } => counts.dropped += 1,
                _ => counts.detected += 1,
            }
        }
        let silent = segments[..done].iter().position(|segment| !segment.reacted);
        let late = segments.get(done);
        if let Err(halt) = went.map_err(Halt::from) {
            let (Halt::Failure(finding), Some(segment)) = (&halt, late) else { return Err(halt) };
            counts.injected += 1;
            counts.failed += 1;
            let found = self.undetected(&segments, done, segment, (**finding).clone());
            self.queue = segments[done + 1..].iter().map(|segment| segment.mask).collect();
            return Ok(Some(found));
        }
        if let Some(silent) = silent {
            if session.slipped {
                return Err(Halt::slipped("no reaction to a falsified SPDU"));
            }
            let found = self.undetected(&segments, silent, &segments[silent], no_reaction(setup.role));
            self.queue = segments[done..].iter().map(|segment| segment.mask).collect();
            return Ok(Some(found));
        }
        match late {
            None => {
                self.queue.clear();
                tester.count = Some(next);
            }
            // Conformant so far, but by another reading than the batch was written for: a partner restores operation.
            Some(segment) => {
                counts.injected += 1;
                if segment.reacted {
                    counts.detected += 1
                } else {
                    counts.dropped += 1
                }
                self.queue = segments[done + 1..].iter().map(|segment| segment.mask).collect();
                tester.count = session.link().sent.as_ref().and_then(|sent| counter(&setup, sent));
                tester.answered = session.answer().map(|view| view.counter());
                let mut tally = Tally::default();
                Stage::new(session, tester, &mut tally).recover()?;
                self.outcome.exchanges += tally.exchanges;
            }
        }
        Ok(None)
    }

    fn undetected(&self, segments: &[Segment], at: usize, segment: &Segment, finding: Finding) -> Undetected {
        // Operation lies between two corruptions: a handful of them is history enough.
        let mut actions = Vec::new();
        for earlier in &segments[at.saturating_sub(3)..at] {
            actions.extend([Action::Corrupt(bits(&earlier.mask)), Action::Good(12)]);
        }
        actions.push(Action::Corrupt(bits(&segment.mask)));
        let script = Script { role: self.target.profile.role, variant: self.variant, seed: self.seed, actions };
        Undetected { octets: segment.bad, script, finding }
    }
}

fn no_reaction(role: Role) -> Finding {
    let (clause, expected) = match role {
        Role::Device => ("11.5.3 Table 40 T25", "SDset 1 and DCommErr 1 in the answer, PDout_D safe"),
        Role::Master => ("11.5.2 Table 38 T7", "setSD 1 in the next SPDU, PDin_M safe and SDset_S 1"),
    };
    Finding {
        kind: "injection/reaction".to_owned(),
        clause: clause.to_owned(),
        expected: expected.to_owned(),
        observed: "no such reaction to a falsified SPDU".to_owned(),
    }
}

fn counter(setup: &Setup, sent: &Octets) -> Option<u8> {
    View::new(sent.as_slice(), setup.mode, setup.sent_pd()).ok().map(|view| view.counter())
}

impl Segment {
    fn is_reaction(&self, setup: &Setup, link: &Link) -> bool {
        let Some(view) = link.answer() else { return false };
        let app = &link.app;
        let shows = |data: Option<Octets>, pd: &Pd| data.is_none_or(|data| data.as_slice() == pd.octets());
        match setup.role {
            Role::Device if self.dropped => shows(app.pdout_d, &self.before),
            Role::Device => {
                let status = view.status();
                status.sd_set && status.d_comm_err && shows(app.pdout_d, &Pd::safe(setup.pd_out))
            }
            Role::Master if self.dropped => shows(app.pdin_m, &self.before),
            Role::Master => {
                view.control().set_sd && app.sdset_s != Some(false) && shows(app.pdin_m, &Pd::safe(setup.pd_in))
            }
        }
    }

    fn is_operation(&self, setup: &Setup, link: &Link) -> bool {
        let Some(view) = link.answer() else { return false };
        let shows = |data: Option<Octets>| data.is_none_or(|data| data.as_slice() == self.after.octets());
        match setup.role {
            Role::Device => !view.status().sd_set && shows(link.app.pdout_d),
            Role::Master => !view.control().set_sd && link.app.sdset_s != Some(true) && shows(link.app.pdin_m),
        }
    }
}

/// Writes a batch from the state the DUT will be in.
struct Writer<'s> {
    setup: &'s Setup,
    copies: usize,
    items: Vec<Item>,
    /// FS-Device: MCount sent last. FS-Master: DCount_i sent last.
    count: u8,
    /// Process data sent last with a good SPDU.
    pd: Pd,
    round: u8,
}

impl<'s> Writer<'s> {
    fn new(setup: &'s Setup, session: &Session<'_>, tester: &Tester) -> Writer<'s> {
        let copies = session.profile.answer_latency as usize + 1;
        let app = &session.link().app;
        let shown = if setup.role == Role::Device { app.pdout_d } else { app.pdin_m };
        let pd = shown.and_then(|data| Pd::new(data.as_slice())).unwrap_or(tester.pd);
        Writer { setup, copies, items: Vec::new(), count: tester.count.unwrap_or(0), pd, round: 0 }
    }

    /// Data that differ from those before and are never safe data.
    fn data(&mut self) -> Pd {
        self.round = self.round.wrapping_add(1);
        let mut octets = [0; fsct_protocol::spdu::MAX_PD];
        (0..)
            .zip(&mut octets)
            .for_each(|(place, octet)| *octet = 1 | self.round.wrapping_mul(59).wrapping_add(37u8.wrapping_mul(place)));
        Pd::new(&octets[..self.setup.sent_pd()]).unwrap_or(Pd::safe(self.setup.sent_pd()))
    }

    fn spdu(&mut self, count: u8) -> Octets {
        self.pd = self.data();
        let (pd, port) = (self.pd, self.setup.port);
        let wire = match self.setup.role {
            Role::Device => {
                OutSpdu { pd, port, control: Control { mcount: count, set_sd: false, ch_f_ack_req: false } }.wire()
            }
            Role::Master => InSpdu { pd, port, status: Status { dcount_i: count, ..Status::default() } }.wire(),
        };
        Octets::new(wire.emit(self.setup.mode, self.setup.reading).octets()).unwrap_or_default()
    }

    fn send(&mut self, octets: Octets) -> usize {
        (0..self.copies).for_each(|_| self.items.push(Item::Exchange(octets)));
        self.items.len() - 1
    }

    fn good(&mut self, count: u8) -> usize {
        let octets = self.spdu(count);
        self.count = count;
        self.send(octets)
    }

    /// The counter of the SPDU after the one with this counter.
    fn next(&self, count: u8) -> u8 {
        match self.setup.role {
            Role::Device => succ(count),
            Role::Master => inv3(succ(inv3(count))),
        }
    }

    /// `None`: the corrupted SPDU carries the right signature.
    fn segment(&mut self, mask: &Mask) -> Option<Segment> {
        let before = self.pd;
        let next = self.next(self.count);
        let good = self.spdu(next);
        let mut falsified = [0; Octets::MAX];
        let length = good.as_slice().len();
        falsified.iter_mut().zip(good.as_slice()).for_each(|(octet, good)| *octet = *good);
        falsified.iter_mut().zip(mask).for_each(|(octet, mask)| *octet ^= mask);
        let bad = Octets::new(&falsified[..length]).unwrap_or_default();
        let view = View::new(bad.as_slice(), self.setup.mode, self.setup.sent_pd()).ok()?;
        if view.signature_matches(self.setup.reading) {
            self.pd = before;
            return None;
        }
        let (shown, zero) = (view.counter(), view.is_all_zero());
        let dropped = shown == self.count || zero;
        let reaction = self.send(bad);
        let restored = match self.setup.role {
            _ if dropped => self.good(next),
            Role::Device => {
                let first = if shown == 0 { 1 } else { 0 };
                self.good(first);
                (0..4).fold(0, |_, _| self.good(succ(self.count)))
            }
            Role::Master => {
                let second = self.next(next);
                self.good(second);
                self.items.push(Item::Set(Service::ChfackC, Octets::bit(true)));
                let third = self.next(second);
                let restored = self.good(third);
                self.items.push(Item::Set(Service::ChfackC, Octets::bit(false)));
                restored
            }
        };
        Some(Segment {
            mask: *mask,
            bad,
            reaction,
            restored,
            dropped,
            before,
            after: self.pd,
            reacted: false,
            operates: false,
        })
    }
}
