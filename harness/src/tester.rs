//! The lower tester: builds the SPDUs a case asks for, legal and illegal, as FS-Master or as FS-Device.

use crate::case::model::{Corrupt, Count, Data, Exchange, Field, Image, KEPT, PortNum, Signature};
use crate::keeper::Keeper;
use crate::oracle::Setup;
use fsct_adapters::{Octets, Role};
use fsct_protocol::ProtMode;
use fsct_protocol::crc::{Reading, crc16, crc32, signature};
use fsct_protocol::spdu::{Pd, Wire, inv3, succ};
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::Rng;
use std::collections::VecDeque;

/// What the tester sent and will count on from.
pub struct Tester {
    setup: Setup,
    rng: Pcg64Mcg,
    /// MCount or DCount_i of the SPDU sent last.
    pub count: Option<u8>,
    /// MCount of the SPDU of an FS-Master that was answered last.
    pub answered: Option<u8>,
    /// Process data sent last.
    pub pd: Pd,
    /// Octets sent last; `None`: nothing.
    pub octets: Option<Octets>,
    /// When the first copy of the SPDU sent last went out, in nanoseconds.
    pub first_copy: u64,
    /// The SPDUs sent, the last one first.
    sent: VecDeque<Octets>,
}

impl Tester {
    /// A tester that has sent nothing.
    pub fn new(setup: &Setup, rng: Pcg64Mcg) -> Tester {
        let pd = Pd::safe(setup.sent_pd());
        Tester {
            pd,
            setup: setup.clone(),
            rng,
            count: None,
            answered: None,
            octets: None,
            first_copy: 0,
            sent: VecDeque::new(),
        }
    }

    /// Forgets what was sent: the DUT has been switched off.
    pub fn restart(&mut self) {
        self.count = None;
        self.answered = None;
        self.octets = None;
        self.sent.clear();
    }

    /// The SPDU sent this many SPDUs before the last one.
    pub fn ago(&self, count: usize) -> Option<Octets> {
        self.sent.get(count).copied()
    }

    /// Keeps an SPDU for `ago`; a copy of the last one is none.
    pub fn remember(&mut self, octets: Option<Octets>) {
        if let Some(octets) = octets
            && self.sent.front() != Some(&octets)
        {
            self.sent.truncate(KEPT - 1);
            self.sent.push_front(octets);
        }
    }

    /// A virtual FS-Device has taken over: the tester goes on from what it sent.
    pub fn follow(&mut self, keeper: &Keeper, now: u64) {
        if self.octets != keeper.octets() {
            self.first_copy = now;
        }
        self.octets = keeper.octets();
        self.remember(self.octets);
        self.pd = keeper.sent();
        self.answered = keeper.answered();
        self.count = self.answered.map(inv3);
    }

    /// Octets of a pattern: none of them 0, from the seed.
    pub fn pattern(&mut self, length: usize) -> Vec<u8> {
        (0..length).map(|_| 1 + (self.rng.next_u32() % 255) as u8).collect()
    }

    /// Builds the octets of the next exchange, with a note on what is wrong with them. `echo` is what the DUT presents,
    /// `shown` the counter in it.
    pub fn build(&mut self, exchange: &Exchange, echo: Option<Octets>, shown: Option<u8>) -> (Option<Octets>, String) {
        let next = match self.setup.role {
            Role::Device => self.count.map_or(0, succ),
            Role::Master => shown.unwrap_or(0),
        };
        let jump = |more: u8| (0..more).fold(next, |count, _| succ(count));
        let mirrored = |mcount: u8| if self.setup.role == Role::Device { mcount } else { inv3(mcount) };
        let count = match exchange.count {
            Count::Next => mirrored(next),
            Count::Same => self.count.unwrap_or(0),
            Count::Jump(more) => mirrored(jump(more)),
            Count::Bit(bit) => mirrored(next) ^ 1 << bit,
            Count::Exactly(count) => count,
        };
        match &exchange.image {
            Image::Spdu => {}
            Image::Zero => return self.instead(Octets::zero(self.length()), "all octets 0"),
            Image::Lost => {
                self.octets = None;
                return (None, "lost".to_owned());
            }
            Image::Echo => {
                // Where the DUT presents nothing, nothing comes back.
                self.octets = echo;
                return (echo, "the DUT's own answer".to_owned());
            }
            Image::Standard => {
                let mut octets = self.pattern(self.length());
                // To an FS-Device the octet in the place of the counter reads as the one awaited: neither old nor a jump.
                if self.setup.role == Role::Device
                    && let Some(place) = octets.get_mut(self.setup.sent_pd() + 1)
                {
                    *place = count << 5 | *place & 0x1F;
                }
                return self.instead(Octets::new(&octets).unwrap_or_default(), "standard process data");
            }
            Image::Ago(count) => {
                return match self.ago(*count) {
                    Some(octets) => self.instead(octets, &format!("the SPDU sent {count} before the last")),
                    None => self.build(&Exchange { image: Image::Lost, ..exchange.clone() }, echo, shown),
                };
            }
            Image::Exactly(octets) => {
                return self.instead(Octets::new(octets).unwrap_or_default(), "octets of the case");
            }
        }
        let (port, own) = (self.setup.port.number(), self.setup.sent_port());
        let port_num = match exchange.port_num {
            PortNum::Own => own,
            PortNum::Inverted => !own,
            PortNum::Foreign => {
                let other = if port == 255 { 254 } else { port + 1 };
                if self.setup.role == Role::Device { other } else { !other }
            }
            PortNum::Exactly(octet) => octet,
        };
        let octet = count << 5 | exchange.bits;
        let pd = self.data(&exchange.pd, self.setup.sent_pd(), &[port_num, octet]);
        let mut notes = Vec::new();
        let signature = self.signature(exchange.signature, &pd, port_num, octet);
        if exchange.signature != Signature::Good {
            notes.push(format!("signature {:?}", exchange.signature).to_lowercase());
        }
        if port_num != own {
            notes.push(format!("PortNum {port_num:02X}"));
        }
        let wire = Wire { pd, port_num, octet, signature };
        let mut emitted = wire.emit(self.setup.mode, self.setup.reading);
        for bit in self.bits(&exchange.corrupt) {
            if let Some(octet) = emitted.octets_mut().get_mut(bit / 8) {
                *octet ^= 0x80 >> (bit % 8);
                notes.push(format!("bit {bit} inverted"));
            }
        }
        self.count = Some(count);
        self.answered = shown;
        self.pd = pd;
        let mut image = emitted.octets().to_vec();
        image.extend(&exchange.nsr);
        self.octets = Octets::new(&image).or(Octets::new(emitted.octets()));
        self.remember(self.octets);
        (self.octets, notes.join(", "))
    }

    /// Process data for a direction; `trailer` are the octets between data and signature.
    pub fn data(&mut self, data: &Data, length: usize, trailer: &[u8]) -> Pd {
        let octets = match data {
            Data::Pattern => self.pattern(length),
            Data::Same => return self.pd,
            Data::Exactly(octets) => {
                let skip = octets.len().saturating_sub(length);
                let mut padded = vec![0; length.saturating_sub(octets.len())];
                padded.extend(octets.iter().skip(skip));
                padded
            }
            Data::ZeroSignature => zero_signature(self.setup.mode, self.setup.reading, length, trailer)
                .unwrap_or_else(|| self.pattern(length)),
            Data::Safe | Data::Bit(_) | Data::Profile => vec![0; length],
        };
        Pd::new(&octets).unwrap_or(Pd::safe(length))
    }

    /// The mirror of the counter in the octets sent last; `None` when they are no SPDU.
    pub fn mirror(&self) -> Option<u8> {
        let octets = self.octets.as_ref()?;
        octets.as_slice().get(self.setup.sent_pd() + 1).map(|octet| inv3(octet >> 5))
    }

    fn length(&self) -> usize {
        self.setup.mode.spdu_octets(self.setup.sent_pd())
    }

    fn instead(&mut self, octets: Octets, note: &str) -> (Option<Octets>, String) {
        self.octets = Some(octets);
        (self.octets, note.to_owned())
    }

    fn signature(&self, kind: Signature, pd: &Pd, port_num: u8, octet: u8) -> Option<u32> {
        let mut secured = pd.octets().to_vec();
        secured.extend([port_num, octet]);
        let good = signature(self.setup.mode, self.setup.reading, &secured);
        match kind {
            Signature::Good => None,
            Signature::Zero => Some(0),
            Signature::Inverted => Some(!good),
            Signature::StartZero => Some(match self.setup.mode {
                ProtMode::Crc16 => crc16(0, &secured).into(),
                ProtMode::Crc32 => crc32(0, &secured),
            }),
            Signature::Reversed => Some(match self.setup.mode {
                ProtMode::Crc16 => (good as u16).swap_bytes().into(),
                ProtMode::Crc32 => good.swap_bytes(),
            }),
            Signature::Order => {
                let end = secured.len();
                secured.swap(end - 2, end - 1);
                Some(signature(self.setup.mode, self.setup.reading, &secured))
            }
        }
    }

    fn bits(&mut self, corrupt: &Corrupt) -> Vec<usize> {
        let pd = 8 * self.setup.sent_pd();
        let (from, count) = match corrupt {
            Corrupt::Nothing => return Vec::new(),
            Corrupt::Bits(bits) => return bits.clone(),
            Corrupt::Field(Field::Data) if pd > 0 => (0, pd),
            Corrupt::Field(Field::Data | Field::Signature) => (pd + 16, 8 * self.setup.mode.signature_octets()),
            Corrupt::Field(Field::PortNum) => (pd, 8),
            Corrupt::Field(Field::Control) if self.setup.role == Role::Device => (pd + 14, 2),
            Corrupt::Field(Field::Control) => (pd + 13, 3),
        };
        vec![from + self.rng.next_u32() as usize % count]
    }
}

/// Process data whose computed signature is 0, so that 1 is sent (11.4.7). The signature is an affine map of the data: a
/// linear system over GF(2) in the last octets. `None` where there is no solution.
pub fn zero_signature(mode: ProtMode, reading: Reading, length: usize, trailer: &[u8]) -> Option<Vec<u8>> {
    let raw = |data: &[u8]| {
        let secured = [data, trailer].concat();
        match (mode, reading) {
            (ProtMode::Crc16, Reading::LeadingOctet) => crc16(0x4EAB, &secured).into(),
            (ProtMode::Crc32, Reading::LeadingOctet) => crc32(0xF4AC_FB13, &secured),
            (ProtMode::Crc16, _) => crc16(1, &secured).into(),
            (ProtMode::Crc32, _) => crc32(1, &secured),
        }
    };
    let mut data = vec![0; length];
    let constant: u32 = raw(&data);
    // Gaussian elimination: each row is the effect of a set of bits, and that set.
    let mut basis: Vec<(u32, Vec<usize>)> = Vec::new();
    for bit in (0..8 * length).rev() {
        data[bit / 8] = 0x80 >> (bit % 8);
        let (mut effect, mut bits) = (raw(&data) ^ constant, vec![bit]);
        data[bit / 8] = 0;
        for (other, set) in &basis {
            if effect ^ other < effect {
                effect ^= other;
                bits.extend(set);
            }
        }
        if effect != 0 {
            basis.push((effect, bits));
            basis.sort_by_key(|(effect, _)| std::cmp::Reverse(*effect));
        }
    }
    let mut rest = constant;
    for (effect, bits) in &basis {
        if rest ^ effect < rest {
            rest ^= effect;
            bits.iter().for_each(|bit| data[bit / 8] ^= 0x80 >> (bit % 8));
        }
    }
    (rest == 0).then_some(data)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rstest::rstest;

    #[rstest]
    #[case(ProtMode::Crc16, 2, &[1, 0x20])]
    #[case(ProtMode::Crc16, 3, &[0xFE, 0xC0])]
    #[case(ProtMode::Crc32, 4, &[1, 0x20])]
    #[case(ProtMode::Crc32, 25, &[200, 0xE3])]
    fn process_data_for_a_signature_of_0_are_found(
        #[case] mode: ProtMode,
        #[case] length: usize,
        #[case] trailer: &[u8],
    ) {
        let data = zero_signature(mode, Reading::Preset, length, trailer).expect("there is a solution");
        let secured = [data.as_slice(), trailer].concat();
        let raw: u32 = match mode {
            ProtMode::Crc16 => crc16(1, &secured).into(),
            ProtMode::Crc32 => crc32(1, &secured),
        };
        assert_eq!(raw, 0);
        assert_eq!(signature(mode, Reading::Preset, &secured), 1);
    }

    /// A tester of an FS-Device that has sent MCount 0 to 3.
    fn running() -> (Tester, Vec<Octets>) {
        let mut tester = Tester::new(&crate::channel::tests::setup(), Pcg64Mcg::new(1));
        let sent = (0..4).filter_map(|_| tester.build(&exchange("{}"), None, None).0).collect();
        (tester, sent)
    }

    fn exchange(text: &str) -> Exchange {
        crate::case::tests::exchange(text)
    }

    #[test]
    fn an_earlier_spdu_goes_out_octet_for_octet_and_counts_for_nothing() {
        let (mut tester, sent) = running();
        let mut built = |text: &str| tester.build(&exchange(text), None, None).0;
        assert_eq!(built("{image: 0 ago}").as_ref(), sent.last());
        assert_eq!(built("{image: 3 ago}").as_ref(), sent.first());
        assert_eq!(built("{image: 4 ago}"), None, "no such SPDU was sent");
        let next = built("{}").expect("an SPDU");
        assert_eq!(next.as_slice()[3] >> 5, 4);
    }

    #[test]
    fn standard_process_data_read_as_the_awaited_counter() {
        let (mut tester, _) = running();
        let octets = tester.build(&exchange("{image: standard}"), None, None).0.expect("octets");
        let view = fsct_protocol::spdu::View::new(octets.as_slice(), ProtMode::Crc16, 2).expect("its length is right");
        assert_eq!((view.counter(), view.signature_matches(Reading::Preset)), (4, false));
    }

    #[rstest]
    #[case("bit 0", 5)]
    #[case("bit 1", 6)]
    #[case("bit 2", 0)]
    fn a_bit_of_the_counter_is_hit_and_the_signature_is_right(#[case] bit: &str, #[case] mcount: u8) {
        let (mut tester, _) = running();
        let octets = tester.build(&exchange(&format!("{{MCount: {bit}}}")), None, None).0.expect("an SPDU");
        let view = fsct_protocol::spdu::View::new(octets.as_slice(), ProtMode::Crc16, 2).expect("its length is right");
        assert_eq!((view.counter(), view.signature_matches(Reading::Preset)), (mcount, true));
    }

    #[test]
    fn where_no_process_data_lead_to_a_signature_of_0_none_are_found() {
        assert_eq!(zero_signature(ProtMode::Crc32, Reading::Preset, 1, &[1, 0x20]), None);
        assert_eq!(zero_signature(ProtMode::Crc16, Reading::Preset, 0, &[1, 0x20]), None);
    }
}
