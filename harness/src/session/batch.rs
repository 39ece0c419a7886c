//! Many exchanges in one go with a look at the link after each: what comes next is known without the answers.

use super::{BATCH, Session, Stop};
use crate::link::Link;
use fsct_adapters::{Dut, Octets, Seen, Service, Stimulus};
use std::sync::atomic::Ordering;

/// One item of a batch.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Item {
    /// An exchange one MasterCycleTime after the one before.
    Exchange(Octets),
    /// An input service of the application is set.
    Set(Service, Octets),
}

impl Session<'_> {
    /// Carries `items` out in order; `look` sees the link behind every exchange, with the position of the item.
    ///
    /// # Errors
    /// [`Stop`] when the case cannot go on. Items behind the one that `look` saw last were not judged, but the DUT may have
    /// got them.
    pub fn carry_out(&mut self, items: &[Item], mut look: impl FnMut(usize, &Link)) -> Result<(), Stop> {
        if self.pace.is_some() || self.kept() {
            for (index, item) in items.iter().enumerate() {
                match item {
                    Item::Exchange(octets) => {
                        self.exchange(Some(*octets))?;
                        look(index, self.link());
                    }
                    Item::Set(service, value) => self.set(*service, *value)?,
                }
            }
            return Ok(());
        }
        let (port, ns) = (self.link().port, self.profile.master_cycle_time_ns);
        let mut stimuli = Vec::with_capacity(2 * BATCH.min(items.len()));
        for (chunk, items) in items.chunks(BATCH).enumerate() {
            stimuli.clear();
            for item in items {
                match item {
                    Item::Exchange(octets) => {
                        let octets = self.link().whole(Some(*octets));
                        stimuli.extend([Stimulus::Advance { ns }, Stimulus::Exchange { port, octets }]);
                    }
                    Item::Set(service, value) => stimuli.push(Stimulus::Set { port, service: *service, value: *value }),
                }
            }
            self.batch(&stimuli, chunk * BATCH, &mut look)?;
        }
        Ok(())
    }

    fn batch(&mut self, stimuli: &[Stimulus], first: usize, look: &mut impl FnMut(usize, &Link)) -> Result<(), Stop> {
        if self.interrupted.load(Ordering::Relaxed) {
            return Err(Stop::Interrupted);
        }
        let mut observed = std::mem::take(&mut self.observed);
        observed.clear();
        let result = self.dut.apply(stimuli, &mut observed);
        let mut rest = observed.as_slice();
        let mut item = first;
        let mut outcome = Ok(());
        'stimuli: for (index, stimulus) in stimuli.iter().enumerate() {
            match stimulus {
                Stimulus::Advance { ns } => self.now += ns,
                // Known to the link when the DUT knows it: exchanges of the same batch came before.
                Stimulus::Set { service, value, .. } => self.link_mut().set(*service, *value),
                _ => {}
            }
            while let Some((observation, later)) = rest.split_first()
                && usize::from(observation.stimulus) == index
            {
                rest = later;
                outcome = self.digest_one(stimulus, observation);
                if outcome.is_err() {
                    break 'stimuli;
                }
                if matches!(observation.seen, Seen::Image { .. }) {
                    look(item, self.link());
                }
            }
            item += usize::from(!matches!(stimulus, Stimulus::Advance { .. }));
        }
        self.observed = observed;
        outcome?;
        result?;
        Ok(())
    }
}
