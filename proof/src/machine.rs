//! Both machines of the tables with what a reading adds to them, and what they have presented.

use crate::reading::{Reading, Reads};
use fsct_protocol::scl::device::{Readings, Received};
use fsct_protocol::scl::master::Answer;
use fsct_protocol::scl::{Device, Master, Path, State, Var};
use fsct_protocol::spdu::{Control, Status, inv3, succ};

/// The images a machine presented in the last exchanges, newest first, as far as the channel stores them.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq, Hash)]
pub(crate) struct Shown([u8; Shown::MOST]);

impl Shown {
    const MOST: usize = *crate::Model::STORING.end() as usize;
    /// No control and no status octet has this bit; with it, none is 0.
    const PRESENT: u8 = 1 << 3;

    /// One exchange later.
    pub(crate) fn then(self, octet: Option<u8>, storing: u8) -> Shown {
        let storing = usize::from(storing).min(Shown::MOST);
        let mut shown = [0; Shown::MOST];
        let images = octet.map(|octet| octet | Shown::PRESENT).into_iter().chain(octet.is_none().then_some(0));
        for (place, image) in shown.iter_mut().zip(images.chain(self.0).take(storing)) {
            *place = image;
        }
        Shown(shown)
    }

    /// The octet presented so many exchanges ago, 1 or more; `None`: nothing, or all zero.
    pub(crate) fn ago(self, ago: u8) -> Option<u8> {
        let image = *self.0.get(usize::from(ago).checked_sub(1)?)?;
        (image != 0).then_some(image & !Shown::PRESENT)
    }

    /// How long ago the images were presented that are others than the one presented now: each the last time it was.
    pub(crate) fn others(self, now: Option<u8>) -> impl Iterator<Item = u8> {
        let mut last = now;
        (1..=Shown::MOST as u8).filter(move |ago| {
            let image = self.ago(*ago);
            let other = image.is_some() && image != last;
            last = image;
            other
        })
    }
}

/// An FS-Master.
#[derive(Copy, Clone, Debug, PartialEq, Eq, Hash)]
pub(crate) struct FsMaster {
    /// The machine of Table 38.
    pub scl: Master,
    /// It has looked at a foreign answer since the last T11 ([`Reading::ForeignOnce`]).
    foreign: bool,
    /// SD cycles that T13 has ended since the last fault, up to three ([`Reading::ThreeCycles`]).
    cycles: u8,
    /// SPDUs it has presented.
    pub shown: Shown,
}

impl FsMaster {
    /// Behind T1 and T2.
    pub(crate) fn started(shown: Shown) -> (FsMaster, Path) {
        let mut scl = Master::new();
        let path = scl.start();
        (FsMaster { scl: scl.settled(false), foreign: false, cycles: 0, shown }, path)
    }

    /// Whether state 7 remembers the previous counter.
    pub(crate) fn remembers(reads: Reads) -> bool {
        FsMaster::looks_back(reads) || reads.has(Reading::OldJudged)
    }

    /// Whether state 7 looks at the previous counter.
    pub(crate) fn looks_back(reads: Reads) -> bool {
        reads.has(Reading::NotOld) || reads.has(Reading::ExpectedOrNotOld)
    }

    /// An answer that is not all zero arrives.
    pub(crate) fn receive(&mut self, answer: Answer, acknowledged: bool, reads: Reads) -> Path {
        if self.takes(answer, reads) { self.process(answer, acknowledged, reads) } else { Path::default() }
    }

    /// Nothing arrives, or all zero.
    pub(crate) fn receive_zero(&mut self, acknowledged: bool, reads: Reads) -> Path {
        if self.scl.state() != State(7) || !reads.has(Reading::ZeroJudged) {
            return Path::default();
        }
        self.receive(Answer { status: Status::default(), intact: false }, acknowledged, reads)
    }

    /// T3, T6, T10 with the readings that say which answer is looked at.
    fn takes(&self, answer: Answer, reads: Reads) -> bool {
        let dcount_i = answer.status.dcount_i;
        let expected = dcount_i == inv3(self.scl.get(Var::Mcount));
        let not_old = self.scl.previous() != Some(dcount_i);
        match self.scl.state().0 {
            2 if reads.has(Reading::FirstExpected) => expected,
            5 | 7 if !answer.intact && reads.has(Reading::OldJudged) => true,
            5 if reads.has(Reading::Expected) => expected && not_old,
            7 if reads.has(Reading::NotOld) => not_old,
            7 if reads.has(Reading::ExpectedOrNotOld) => expected || not_old,
            7 if reads.has(Reading::ForeignOnce) => expected || !self.foreign,
            _ => self.scl.takes(dcount_i),
        }
    }

    fn process(&mut self, answer: Answer, acknowledged: bool, reads: Reads) -> Path {
        let foreign = self.scl.state() == State(7) && answer.status.dcount_i != inv3(self.scl.get(Var::Mcount));
        // Not yet T11, which would end the third: T13, and the acknowledgment stays armed, for T13 with ChFAck_C at 0 arms it.
        let waits = reads.has(Reading::ThreeCycles) && self.cycles < 2 && self.scl.get(Var::ChFAckCe) == 1;
        self.scl.set_ch_f_ack_c(acknowledged && !waits);
        let path = self.scl.process(answer);
        let took = |numbers: &[u8]| path.iter().any(|t| numbers.contains(&t.0));
        if took(&[11]) {
            (self.foreign, self.cycles) = (false, 0);
        } else if took(&[7, 12]) {
            self.foreign |= reads.has(Reading::ForeignOnce) && foreign;
            self.cycles = 0;
        } else if took(&[13]) && reads.has(Reading::ThreeCycles) {
            self.cycles = (self.cycles + 1).min(3);
        }
        path
    }

    /// MTimer expires.
    pub(crate) fn expire(&mut self) -> Path {
        self.cycles = 0;
        self.scl.expire()
    }

    /// Without the inputs of the exchange; in it, what it presented went to the store.
    pub(crate) fn settled(self, kept: bool, shown: Shown) -> FsMaster {
        FsMaster { scl: self.scl.settled(kept), shown, ..self }
    }
}

/// An FS-Device; in state 20 it has no power.
#[derive(Copy, Clone, Debug, PartialEq, Eq, Hash)]
pub(crate) struct FsDevice {
    /// The machine of Table 40.
    pub scl: Device,
    /// Answers it has presented.
    pub shown: Shown,
}

impl FsDevice {
    /// Without power.
    pub(crate) fn off(reads: Reads, shown: Shown) -> FsDevice {
        FsDevice { scl: Device::new(readings(reads.kept())), shown }
    }

    /// An SPDU that is not all zero arrives: T21, T24, T27 with the readings that say which one is looked at.
    pub(crate) fn receive(&mut self, received: Received, reads: Reads) -> Path {
        let Received { control: Control { mcount, .. }, intact } = received;
        let first = self.scl.state() == State(21);
        let next = self.scl.previous().map(succ) == Some(mcount);
        let valid = intact && (self.scl.counter_check(mcount) || first && mcount == 1 && reads.has(Reading::FirstOne));
        let jump = !next && mcount != 0;
        let left_alone = !first
            && (reads.has(Reading::ExactlyNext) && !next
                || reads.has(Reading::NextOrZero) && jump
                || reads.has(Reading::JumpIgnored) && jump && intact
                || self.scl.is_old(mcount) && (intact || !reads.has(Reading::OldJudged)));
        if left_alone { Path::default() } else { self.process(received, valid, reads) }
    }

    /// Nothing arrives, or all zero.
    pub(crate) fn receive_zero(&mut self, reads: Reads) -> Path {
        if self.scl.state() != State(24) || !reads.has(Reading::ZeroJudged) {
            return Path::default();
        }
        self.receive(Received { control: Control::default(), intact: false }, reads)
    }

    fn process(&mut self, received: Received, valid: bool, reads: Reads) -> Path {
        self.scl.set_readings(readings(reads));
        let path = self.scl.process(received, valid);
        self.scl.set_readings(readings(reads.kept()));
        path
    }

    /// Without the inputs of the exchange.
    pub(crate) fn settled(self) -> FsDevice {
        FsDevice { scl: self.scl.settled(), ..self }
    }
}

/// The readings that stand in the rows, or beside them in what is remembered.
fn readings(reads: Reads) -> Readings {
    Readings {
        last_valid: reads.has(Reading::LastValid),
        previous_valid: reads.has(Reading::PreviousValid),
        mirror_valid: reads.has(Reading::MirrorValid),
        sequential: reads.has(Reading::Sequential),
        set_sd_dc_kept: reads.has(Reading::SetSdDcKept),
        zero_reloads: reads.has(Reading::ZeroReloads),
        ..Readings::default()
    }
}
