//! What is explored: the edition, how the tables are read, the timers, and what may go wrong.

use crate::reading::{Machine, Reading, Reads};
use core::fmt;
use core::str::FromStr;
use fsct_observed::{Mealy, Seen};
use fsct_protocol::Edition;
use std::sync::Arc;

/// How the image that an FS-Device returns in an exchange relates to the one it receives there.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq)]
pub enum Timing {
    /// The image made before this exchange: an undisturbed SCL cycle takes two exchanges.
    #[default]
    Pipelined,
    /// The answer itself: an undisturbed SCL cycle takes one exchange.
    Immediate,
}

impl FromStr for Timing {
    type Err = String;

    fn from_str(text: &str) -> Result<Timing, String> {
        match text {
            "P" => Ok(Timing::Pipelined),
            "I" => Ok(Timing::Immediate),
            _ => Err(format!("`{text}` is no timing; P (pipelined) and I (immediate answers) are")),
        }
    }
}

impl fmt::Display for Timing {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Timing::Pipelined => "P",
            Timing::Immediate => "I",
        })
    }
}

/// When a running timer may expire.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq)]
pub enum Timers {
    /// When it has counted as many exchanges as [`Model::watchdog`].
    #[default]
    Counted,
    /// In any exchange: no watchdog is too short or too long to be among them.
    Any,
}

impl FromStr for Timers {
    type Err = String;

    fn from_str(text: &str) -> Result<Timers, String> {
        match text {
            "counted" => Ok(Timers::Counted),
            "nd" => Ok(Timers::Any),
            _ => Err(format!("`{text}` is no kind of timers; counted and nd (may expire in any exchange) are")),
        }
    }
}

impl fmt::Display for Timers {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Timers::Counted => "counted",
            Timers::Any => "nd",
        })
    }
}

/// What is explored. The default is that of the standard's tables with a watchdog of four exchanges and a channel that may do anything.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Model {
    /// Edition of the tables.
    pub edition: Edition,
    /// Readings that depart from the default, each followed by the machines it is about.
    pub readings: Vec<Reading>,
    /// Readings of the FS-Master alone.
    pub master_readings: Vec<Reading>,
    /// Readings of the FS-Device alone.
    pub device_readings: Vec<Reading>,
    /// In each exchange a machine follows whichever of its readings it likes, or none, but for those that say what it remembers
    /// (A08, A16): what holds then holds for every combination of them.
    pub mixed: bool,
    /// FSP_Watchdog in exchanges, [`Model::WATCHDOGS`].
    pub watchdog: u8,
    /// When answers come back.
    pub timing: Timing,
    /// When timers expire.
    pub timers: Timers,
    /// An SPDU that was presented up to so many exchanges ago may reach the FS-Device, [`Model::STORING`]; 0: nothing is stored.
    pub storing: u8,
    /// The same for answers on their way to the FS-Master.
    pub storing_answers: u8,
    /// Most disturbed exchanges, [`Model::FAULTS`]; `None`: any number. A power cycle of the FS-Device is not one of them.
    pub faults: Option<u8>,
    /// The FS-Device may lose its power at any time for any time.
    pub power_cycles: bool,
    /// The FS-Master may start anew at any time.
    pub master_restart: bool,
    /// The machine of a product in place of the FS-Device ([`crate::can_stand_in`]).
    pub device: Option<Arc<Mealy<Seen>>>,
    /// The machine of a product in place of the FS-Master.
    pub master: Option<Arc<Mealy<Seen>>>,
    /// Most states kept in one search, so that memory is bounded: a state takes some 60 octets.
    pub most_states: usize,
}

impl Model {
    /// Watchdogs that can be explored, in exchanges.
    pub const WATCHDOGS: core::ops::RangeInclusive<u8> = 2..=15;
    /// States kept at most unless told otherwise: some 300 MB.
    pub const MOST_STATES: usize = 5_000_000;
    /// Numbers of disturbed exchanges that can be counted.
    pub const FAULTS: core::ops::RangeInclusive<u8> = 0..=14;
    /// Exchanges for which images can be stored.
    pub const STORING: core::ops::RangeInclusive<u8> = 0..=15;

    /// Both machines as the tables of an edition are read by default.
    pub fn new(edition: Edition) -> Model {
        Model {
            edition,
            readings: Vec::new(),
            master_readings: Vec::new(),
            device_readings: Vec::new(),
            mixed: false,
            watchdog: 4,
            timing: Timing::Pipelined,
            timers: Timers::Counted,
            storing: 0,
            storing_answers: 0,
            faults: None,
            power_cycles: true,
            master_restart: false,
            device: None,
            master: None,
            most_states: Model::MOST_STATES,
        }
    }

    /// Whether a reading is followed by a machine.
    pub fn reads(&self, reading: Reading) -> bool {
        Machine::ALL.into_iter().any(|machine| self.readings_of(machine).contains(&reading))
    }

    /// The readings a machine follows.
    pub fn readings_of(&self, machine: Machine) -> Vec<Reading> {
        let shared = self.readings.iter().filter(|reading| reading.concerns(machine));
        let alone = match machine {
            Machine::Master => &self.master_readings,
            Machine::Device => &self.device_readings,
        };
        shared.chain(alone).copied().collect()
    }

    /// The sets of readings a machine chooses from in each exchange.
    pub(crate) fn ways(&self, machine: Machine) -> Vec<Reads> {
        let all = self.readings_of(machine).into_iter().fold(Reads::default(), Reads::with);
        if self.mixed { all.mixtures() } else { vec![all] }
    }

    /// Exchanges of an undisturbed SCL cycle.
    pub fn scl_cycle(&self) -> u8 {
        match self.timing {
            Timing::Pipelined => 2,
            Timing::Immediate => 1,
        }
    }

    /// Whether the channel stores images, either way.
    pub fn stores(&self) -> bool {
        self.storing > 0 || self.storing_answers > 0
    }

    /// Whether it can be explored.
    ///
    /// # Errors
    /// One sentence with what cannot and the remedy.
    pub fn check(&self) -> Result<(), String> {
        let (watchdogs, faults) = (Model::WATCHDOGS, Model::FAULTS);
        if !watchdogs.contains(&self.watchdog) {
            let (least, most) = (watchdogs.start(), watchdogs.end());
            return Err(format!("a watchdog of {} exchanges; {least} to {most} can be explored", self.watchdog));
        }
        if self.faults.is_some_and(|count| !faults.contains(&count)) {
            return Err(format!("more than {} disturbed exchanges are not counted; take `unlimited`", faults.end()));
        }
        if self.reads(Reading::FirstOne) && self.edition == Edition::Iec2022 {
            return Err(format!("{} is a reading of v1.1 alone (11.5.3): iec2022 demands 0", Reading::FirstOne));
        }
        let most = *Model::STORING.end();
        if self.storing.max(self.storing_answers) > most {
            return Err(format!("images are stored for {most} exchanges at most"));
        }
        for machine in Machine::ALL {
            self.check_readings(machine)?;
        }
        self.check_products()
    }

    /// What a product does was learnt, so nothing about the tables can be asked of its side.
    fn check_products(&self) -> Result<(), String> {
        let products = [(Machine::Device, self.device.is_some()), (Machine::Master, self.master.is_some())];
        let products: Vec<Machine> = products.into_iter().filter_map(|(machine, is)| is.then_some(machine)).collect();
        let left =
            |reading: &&Reading| !Machine::ALL.iter().any(|one| !products.contains(one) && reading.concerns(*one));
        let own = |machine: &Machine| match machine {
            Machine::Device => self.device_readings.first(),
            Machine::Master => self.master_readings.first(),
        };
        let order = |reading: &&Reading| !matches!(reading, Reading::TimerFirst | Reading::ReceptionFirst);
        let given = products.iter().find_map(own).or(self.readings.iter().filter(order).find(left));
        if let Some(reading) = given.filter(|_| !products.is_empty()) {
            return Err(format!("{reading} is a reading of the tables, and a product stands in for them there"));
        }
        if !products.is_empty() && (self.storing.max(self.storing_answers) > 0 || self.master_restart) {
            return Err("with a product nothing is stored and the FS-Master does not start anew".to_owned());
        }
        Ok(())
    }

    fn check_readings(&self, machine: Machine) -> Result<(), String> {
        let readings = self.readings_of(machine);
        if let Some(reading) = readings.iter().find(|reading| !reading.concerns(machine)) {
            return Err(format!("{reading} is no reading of an {machine}"));
        }
        // A machine that mixes its readings may have several answers to one question.
        for (at, reading) in readings.iter().enumerate().filter(|_| !self.mixed) {
            if let Some(other) = readings.iter().skip(at + 1).find(|other| reading.excludes(**other)) {
                return Err(format!("{reading} and {other} answer the same question; take one"));
            }
        }
        Ok(())
    }
}
