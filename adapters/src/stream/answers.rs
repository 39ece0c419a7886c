//! Whether what a DUT answers keeps to the contract: the right answers, in order, and not too many.

use crate::{Description, DutError, Line, Observation, Role, Seen, Stimulus};

/// Observations a stimulus can cause at the most, on average.
pub const FLOOD_PER_STIMULUS: usize = 64;
/// Observations a request can cause beyond that.
pub const FLOOD_SLACK: usize = 1024;

/// Follows the answers to one request.
pub(super) struct Answers<'a> {
    asked: &'a [Stimulus],
    /// Position of the request in its batch, for the texts.
    first: usize,
    /// Position in `asked` of the stimulus that is being answered.
    current: usize,
    /// What there has been for it.
    image: bool,
    answer: bool,
    unsupported: bool,
    count: usize,
}

impl<'a> Answers<'a> {
    pub(super) fn to(asked: &'a [Stimulus], first: usize) -> Answers<'a> {
        Answers { asked, first, current: 0, image: false, answer: false, unsupported: false, count: 0 }
    }

    /// Looks at the next observation, its stimulus counted from the first of the request.
    pub(super) fn take(&mut self, observation: &Observation) -> Result<(), DutError> {
        self.count += 1;
        let limit = FLOOD_PER_STIMULUS * self.asked.len() + FLOOD_SLACK;
        if self.count > limit {
            return Err(DutError::Flood { limit });
        }
        let position = usize::from(observation.stimulus);
        if position >= self.asked.len() {
            let what = format!("an observation of stimulus {position} in a request of {}", self.asked.len());
            return Err(DutError::Contract { what });
        }
        if position < self.current {
            return self.broken(&format!("an observation of stimulus {} comes after one", self.first + position));
        }
        while self.current < position {
            self.leave()?;
        }
        if self.image {
            return self.broken("an observation comes after the image");
        }
        match (self.asked.get(self.current), &observation.seen) {
            (Some(Stimulus::Exchange { port, .. }), Seen::Image { port: at, .. }) => {
                if port != at {
                    return self.broken(&format!("the image is on port {at}, the exchange on port {port}"));
                }
                self.image = true;
            }
            (_, Seen::Image { .. }) => return self.broken("an image that was not asked for"),
            (Some(Stimulus::Read { .. }), Seen::Value(_) | Seen::Refused { .. } | Seen::Unsupported)
            | (Some(Stimulus::Write { .. }), Seen::Written | Seen::Refused { .. } | Seen::Unsupported)
            | (Some(Stimulus::Smi(_)), Seen::Smi(_) | Seen::Unsupported) => {
                if self.answer {
                    return self.broken("a second answer");
                }
                self.answer = true;
            }
            (_, Seen::Value(_) | Seen::Written | Seen::Refused { .. } | Seen::Smi(_)) => {
                return self.broken("an answer that was not asked for");
            }
            (_, Seen::Unsupported) if self.unsupported => return self.broken("\"unsupported\" is said twice"),
            (_, Seen::Unsupported) => self.unsupported = true,
            (_, Seen::Line { line: Line::WakeUp, level: false, .. }) => {
                return self.broken("a wake-up pulse of level 0");
            }
            (
                _,
                Seen::Service { .. }
                | Seen::Event { .. }
                | Seen::Mode { .. }
                | Seen::Request { .. }
                | Seen::Line { .. }
                | Seen::Indication { .. },
            ) => {}
        }
        Ok(())
    }

    /// No more observations come.
    pub(super) fn end(mut self) -> Result<(), DutError> {
        while self.current < self.asked.len() {
            self.leave()?;
        }
        Ok(())
    }

    /// Goes on to the next stimulus.
    fn leave(&mut self) -> Result<(), DutError> {
        match self.asked.get(self.current) {
            Some(Stimulus::Exchange { .. }) if !self.image => return self.broken("no image"),
            Some(Stimulus::Read { .. } | Stimulus::Write { .. } | Stimulus::Smi(_)) if !self.answer => {
                return self.broken("no answer");
            }
            _ => {}
        }
        self.current += 1;
        (self.image, self.answer, self.unsupported) = (false, false, false);
        Ok(())
    }

    fn broken(&self, what: &str) -> Result<(), DutError> {
        let kind = match self.asked.get(self.current) {
            Some(Stimulus::Configure(_)) => "configure",
            Some(Stimulus::Power(_)) => "power",
            Some(Stimulus::Exchange { .. }) => "exchange",
            Some(Stimulus::Read { .. }) => "read",
            Some(Stimulus::Write { .. }) => "write",
            Some(Stimulus::Set { .. }) => "set",
            Some(Stimulus::Advance { .. }) => "advance",
            Some(Stimulus::Plug { .. }) => "plug",
            Some(Stimulus::Respond { .. }) => "respond",
            Some(Stimulus::Raise { .. }) => "raise",
            Some(Stimulus::Drive { .. }) => "drive",
            Some(Stimulus::Smi(_)) => "smi",
            Some(Stimulus::Other { .. }) | None => "unknown kind",
        };
        Err(DutError::Contract { what: format!("{what}, stimulus {} ({kind})", self.first + self.current) })
    }
}

/// Whether a description can be true.
pub(super) fn check_description(description: &Description) -> Result<(), DutError> {
    let broken = |what: String| Err(DutError::Contract { what });
    match (description.role, description.ports) {
        (Role::Device, 1) | (Role::Master, 1..) => {}
        (role, ports) => return broken(format!("an FS-{role} with {ports} ports")),
    }
    if description.offers.is_empty() {
        return broken("it offers nothing it can be configured as".to_owned());
    }
    for offer in &description.offers {
        for (least, greatest) in [offer.pd_out, offer.pd_in] {
            if least > greatest || usize::from(greatest) > offer.mode.max_pd() {
                let most = offer.mode.max_pd();
                return broken(format!(
                    "it offers {least} to {greatest} octets with {}, which holds {most}",
                    offer.mode
                ));
            }
        }
    }
    Ok(())
}
