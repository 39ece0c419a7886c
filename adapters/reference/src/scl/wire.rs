//! What the machine reads out of an SPDU and how it makes one: checks, signature, bits of the counter octets.

use super::{Inputs, Scl, State};
use crate::Mutant;
use crate::parameters::{PADDING, boolean_octets};
use fsct_protocol::ProtMode;
use fsct_protocol::crc::{Reading, crc16, crc32};
use fsct_protocol::spdu::{Control, Pd, Status, View, Wire};

impl Scl {
    /// The Control&MCnt octet.
    pub(super) fn control(&self, spdu: &View<'_>) -> Control {
        let control = Control::from_octet(spdu.octet());
        let Control { set_sd, ch_f_ack_req, .. } = control;
        match self.config.mutant {
            Some(Mutant::ControlBitsSwapped) => Control { set_sd: ch_f_ack_req, ch_f_ack_req: set_sd, ..control },
            Some(Mutant::AckReqAsSetSd) => Control { set_sd: set_sd || ch_f_ack_req, ..control },
            _ => control,
        }
    }

    /// The counter check: 0 or the next one; the first has to be 0.
    pub(super) fn counter_good(&self, previous: Option<u8>, received: u8) -> bool {
        match self.config.mutant {
            Some(Mutant::CounterCheckMissing) => return true,
            Some(Mutant::FirstCounterAny) if previous.is_none() => return true,
            Some(Mutant::FirstCounterOne) if previous.is_none() && received == 1 => return true,
            Some(Mutant::SkipTaken) if previous.is_some_and(|previous| received == previous % 7 + 2) => return true,
            Some(Mutant::ZeroRefused) if previous.is_some() && received == 0 => return false,
            Some(Mutant::WrapToZero) if previous == Some(7) => return received == 0,
            _ => {}
        }
        match previous {
            _ if received == 0 => true,
            None => false,
            Some(7) => received == 1,
            Some(previous) => received == previous + 1,
        }
    }

    pub(super) fn port_good(&self, spdu: &View<'_>) -> bool {
        let (own, received) = (self.config.port, spdu.port_num());
        match self.config.mutant {
            Some(Mutant::PortUnchecked) => true,
            Some(Mutant::CounterAloneChecked) if self.state == State::WaitOnSpdu24 => true,
            Some(Mutant::PortUncheckedAfterFault) if self.state == State::WaitOnSpdu26 => true,
            Some(Mutant::PortInvertedTaken) if received == own.inverted() => true,
            _ => received == own.number(),
        }
    }

    pub(super) fn signature_good(&self, octets: &[u8], spdu: &View<'_>) -> bool {
        let secured = octets.get(..spdu.pd().len() + 2).unwrap_or_default();
        let (right, received) = (self.signature(secured), spdu.signature());
        match self.config.mutant {
            Some(Mutant::CounterAloneChecked) if self.state == State::WaitOnSpdu24 => true,
            Some(Mutant::SignatureUncheckedAfterFault) if self.state == State::WaitOnSpdu26 => true,
            Some(Mutant::SignatureUncheckedWithoutData) if spdu.pd().is_empty() => true,
            Some(Mutant::Crc32HalfCompared) => right & 0xFFFF == received & 0xFFFF,
            Some(Mutant::ZeroReceivedTaken) if received == 0 => self.computed(secured) == 0,
            _ => right == received,
        }
    }

    /// Process data for the technology.
    pub(super) fn received_pd(&self, spdu: &View<'_>) -> Pd {
        let mut octets = spdu.pd().to_vec();
        match self.config.mutant {
            Some(Mutant::PdoutReversed) => octets.reverse(),
            Some(Mutant::PdoutTailLost) => return self.without_tail(&octets),
            _ => {}
        }
        Pd::new(&octets).unwrap_or(Pd::safe(octets.len()))
    }

    /// Process data whose last octet is 0 if they are as long as the mode allows.
    fn without_tail(&self, octets: &[u8]) -> Pd {
        let mut octets = octets.to_vec();
        if octets.len() == self.config.mode.max_pd() {
            octets.last_mut().into_iter().for_each(|octet| *octet = 0);
        }
        Pd::new(&octets).unwrap_or(Pd::safe(octets.len()))
    }

    fn sent_pd(&mut self, inputs: &Inputs) -> Pd {
        let before = self.pd_in.replace(inputs.pd_in);
        match self.config.mutant {
            Some(Mutant::PdinLate) => before.unwrap_or(inputs.pd_in),
            Some(Mutant::PdinReversed) => {
                let octets: Vec<u8> = inputs.pd_in.octets().iter().rev().copied().collect();
                Pd::new(&octets).unwrap_or(inputs.pd_in)
            }
            Some(Mutant::PaddingNotZero) => with_padding_set(inputs.pd_in),
            Some(Mutant::PdinTailLost) => self.without_tail(inputs.pd_in.octets()),
            _ => inputs.pd_in,
        }
    }

    /// The Status&DCnt octet.
    fn status_octet(&self, status: Status) -> u8 {
        let octet = status.to_octet();
        let count = status.dcount_i;
        let with_count = |count: u8| octet & 0x1F | count << 5;
        match self.config.mutant {
            Some(Mutant::DCommErrNeverReported) => octet & !0x02,
            Some(Mutant::ErrorBitsSwapped) => octet & !0x03 | (octet & 0x01) << 1 | (octet & 0x02) >> 1,
            Some(Mutant::SdSetInBit3) => octet & !0x04 | (octet & 0x04) << 1,
            Some(Mutant::ReservedBitsSet) => octet | 0x18,
            Some(Mutant::DCountPlain) => with_count(7 - count),
            Some(Mutant::DCountOffByOne) => with_count((count + 1) % 8),
            Some(Mutant::DCountBitsReversed) => with_count(count.reverse_bits() >> 5),
            _ => octet,
        }
    }

    pub(super) fn send_spdu(&mut self, status: Status, inputs: &Inputs) {
        let port = self.config.port;
        let wire = Wire {
            pd: self.sent_pd(inputs),
            port_num: if self.is(Mutant::PortNotInverted) { port.number() } else { port.inverted() },
            octet: self.status_octet(status),
            signature: Some(0),
        };
        let mut spdu = wire.emit(self.config.mode, Reading::Preset);
        let octets = spdu.octets_mut();
        let length = self.config.mode.signature_octets();
        if let Some((secured, sent)) = octets.split_at_mut_checked(octets.len().saturating_sub(length)) {
            let signature = self.signature(secured).to_be_bytes();
            sent.copy_from_slice(&signature[signature.len() - length..]);
            if self.is(Mutant::Crc16OctetsSwapped) && length == 2 {
                sent.reverse();
            }
        }
        self.answer = Some(spdu);
    }

    /// The signature over `secured`: start value 1, a result of 0 becomes 1 (11.4.7).
    fn signature(&self, secured: &[u8]) -> u32 {
        let zero_kept = match self.config.mutant {
            Some(Mutant::ZeroNotReplaced) => true,
            Some(Mutant::ZeroKeptCrc32) => self.config.mode == ProtMode::Crc32,
            _ => false,
        };
        let computed = self.computed(secured);
        if computed == 0 && !zero_kept { 1 } else { computed }
    }

    fn computed(&self, secured: &[u8]) -> u32 {
        let seed = if self.is(Mutant::WrongSeed) { 0 } else { 1 };
        let mut swapped = secured.to_vec();
        let secured = match swapped.as_mut_slice() {
            [.., port, counter] if self.is(Mutant::ControlBeforePort) => {
                std::mem::swap(port, counter);
                &swapped
            }
            _ => secured,
        };
        match self.config.mode {
            ProtMode::Crc16 => crc16(seed as u16, secured).into(),
            ProtMode::Crc32 => crc32(seed, secured),
        }
    }
}

/// Process data with the padding of their last Boolean octet set.
fn with_padding_set(pd: Pd) -> Pd {
    let mut octets = pd.octets().to_vec();
    let booleans = boolean_octets(u8::try_from(octets.len()).unwrap_or(0));
    let last = usize::from(booleans).checked_sub(1).and_then(|last| octets.get_mut(last));
    last.into_iter().for_each(|octet| *octet |= PADDING);
    Pd::new(&octets).unwrap_or(pd)
}
