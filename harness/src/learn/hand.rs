//! The tester's hand on the link during one word: it offers something, or waits for the watchdog, and says whether anything new came.

use super::Trouble;
use crate::oracle::Setup;
use crate::session::{Item, Session};
use crate::tester::Tester;
use fsct_adapters::{Octets, Role, Service};
use fsct_protocol::spdu::{Pd, Wire};

/// The hand.
pub struct Hand<'h, 'd> {
    session: &'h mut Session<'d>,
    tester: &'h mut Tester,
    /// Since when the watchdog of the DUT runs, in nanoseconds on its clock; `None`: it does not.
    since: Option<u64>,
}

impl<'h, 'd> Hand<'h, 'd> {
    /// Nothing has been done yet.
    pub fn new(session: &'h mut Session<'d>, tester: &'h mut Tester) -> Hand<'h, 'd> {
        Hand { session, tester, since: None }
    }

    /// What has been seen so far.
    pub fn session(&self) -> &Session<'d> {
        self.session
    }

    /// The SPDU the DUT presents; `None`: all zero or nothing.
    fn image(&self) -> Option<Octets> {
        self.session.answer().and(self.session.link().image)
    }

    /// New process data, none of the octets 0 but what a declared structure leaves out.
    pub fn pattern(&mut self, length: usize) -> Octets {
        let mut octets = self.tester.pattern(length);
        if let Some(structure) = self.session.profile.structure
            && self.session.role() == Role::Device
            && structure.input.octets() == length
        {
            structure.input.clear_padding(&mut octets);
        }
        Octets::new(&octets).unwrap_or_default()
    }

    /// An SPDU of the tester with this octet of counter and flags and these process data, its signature right or hit in one bit.
    pub fn spdu(&mut self, octet: u8, pd: Octets, intact: bool) -> Option<Octets> {
        let setup = self.session.setup();
        let pd = Pd::new(pd.as_slice()).unwrap_or(Pd::safe(setup.sent_pd()));
        let mut wire = Wire { pd, port_num: setup.sent_port(), octet, signature: None }.emit(setup.mode, setup.reading);
        let bits = 8 * setup.mode.signature_octets();
        if !intact {
            let bit = self.tester.pattern(1).first().map_or(0, |octet| usize::from(*octet)) % bits;
            if let Some(octet) = wire.octets_mut().iter_mut().rev().nth(bit / 8) {
                *octet ^= 1 << (bit % 8);
            }
        }
        Octets::new(wire.octets())
    }

    /// All octets 0, as long as an SPDU of the tester.
    pub fn all_zero(&self) -> Octets {
        let setup = self.session.setup();
        Octets::zero(setup.mode.spdu_octets(setup.sent_pd()))
    }

    /// Sets services of the application and offers an SPDU, or nothing, for as long as the DUT may take to answer. Whether it
    /// presents something else behind it.
    ///
    /// # Errors
    /// [`Trouble`].
    pub fn offer(&mut self, sets: &[(Service, Octets)], octets: Option<Octets>) -> Result<bool, Trouble> {
        let (cycle, exchanges) = (self.session.profile.master_cycle_time_ns, self.session.profile.answer_latency + 1);
        let (first, image) = (self.session.now + cycle, self.image());
        let last = self.session.now + exchanges * cycle;
        let setup = self.session.setup();
        let early = setup.tick_ns + setup.uncertainty_ns + cycle;
        if self.since.is_some_and(|since| last + early > since + setup.watchdog_ns) {
            return Err(Trouble::Short(self.session.profile.watchdog_ms));
        }
        match octets {
            Some(octets) => {
                let mut items: Vec<Item> = sets.iter().map(|(service, value)| Item::Set(*service, *value)).collect();
                items.extend((0..exchanges).map(|_| Item::Exchange(octets)));
                self.session.carry_out(&items, |_, _| {})?;
            }
            None => {
                sets.iter().try_for_each(|(service, value)| self.session.set(*service, *value))?;
                (0..exchanges).try_for_each(|_| self.session.exchange(None))?;
            }
        }
        let changed = self.image() != image;
        if changed {
            // DTimer starts with the SPDU that is answered, MTimer with the new one.
            self.since = Some(match self.session.role() {
                Role::Device => first,
                Role::Master => self.session.link().changed_at,
            });
        }
        Ok(changed)
    }

    /// Sets services of the application and offers nothing until the watchdog of the DUT has to have expired, and shows it. Whether
    /// the DUT presents something else behind it.
    ///
    /// # Errors
    /// [`Trouble`].
    pub fn time_out(&mut self, sets: &[(Service, Octets)]) -> Result<bool, Trouble> {
        let Setup { watchdog_ns, tick_ns, margin_ns, uncertainty_ns, cycle_ns, latency, .. } = *self.session.setup();
        let late = tick_ns + margin_ns + uncertainty_ns + (latency + 1) * cycle_ns;
        let until = self.since.unwrap_or(self.session.now) + watchdog_ns + late;
        let image = self.image();
        sets.iter().try_for_each(|(service, value)| self.session.set(*service, *value))?;
        self.session.exchange_until(until, None)?;
        let changed = self.image() != image;
        if changed {
            self.since = Some(self.session.link().changed_at);
        } else if self.since.is_some() {
            self.since = Some(self.session.now);
        }
        Ok(changed)
    }
}
