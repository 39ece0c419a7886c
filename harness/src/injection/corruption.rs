//! All corruptions of an SPDU with so many bits inverted, all bursts of a length, or some of those drawn at random.

use fsct_protocol::spdu::MAX_SPDU;
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::{Rng, SeedableRng};

/// Bits that are inverted, as octets to combine with an SPDU by exclusive or.
pub type Mask = [u8; MAX_SPDU];

/// The most bits a corruption can have here, bursts apart.
pub const MAX_FLIPS: usize = 8;
/// The longest burst: as long as the longer signature, so that every one of them has to be detected there.
pub const MAX_BURST: usize = 32;
/// The longest burst of which all are tried in one go: a bit more doubles their number.
pub const MAX_ALL_BURSTS: usize = 24;

/// Which corruptions.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Kind {
    /// So many bits inverted, anywhere.
    Flips(usize),
    /// The first and the last bit of a stretch of so many inverted, those between in every combination.
    Burst(usize),
}

impl Kind {
    /// How many there are in an SPDU of this many octets.
    pub fn count(self, octets: usize) -> u64 {
        let bits = 8 * octets as u64;
        match self {
            Kind::Flips(flips) => (0..flips as u64).fold(1, |count, k| count * bits.saturating_sub(k) / (k + 1)),
            Kind::Burst(length) if length as u64 > bits => 0,
            Kind::Burst(length) => (bits - length as u64 + 1) << length.saturating_sub(2),
        }
    }
}

/// The corruptions of one kind, in order.
#[derive(Clone, Debug)]
pub struct Corruptions {
    kind: Kind,
    bits: usize,
    /// Flips: the positions. Burst: `[0]` is where it starts.
    at: [usize; MAX_FLIPS],
    /// Burst: the inner bits.
    inner: u32,
    /// Burst: how many more are to be drawn, and from what; `None`: all come.
    drawn: Option<(u64, Pcg64Mcg)>,
    total: u64,
    done: bool,
}

impl Corruptions {
    /// Those of an SPDU of this many octets.
    pub fn new(kind: Kind, octets: usize) -> Corruptions {
        let mut at = [0; MAX_FLIPS];
        at.iter_mut().enumerate().for_each(|(index, place)| *place = index);
        let total = kind.count(octets);
        Corruptions { kind, bits: 8 * octets, at, inner: 0, drawn: None, total, done: total == 0 }
    }

    /// So many of the bursts of a length, drawn at random; all of them when there are no more.
    pub fn drawn(length: usize, octets: usize, number: u64, seed: u64) -> Corruptions {
        let mut all = Corruptions::new(Kind::Burst(length), octets);
        if number < all.total {
            all.total = number;
            all.drawn = Some((number, Pcg64Mcg::seed_from_u64(seed ^ ((length as u64) << 8) ^ octets as u64)));
            all.draw(length);
        }
        all
    }

    /// How many there are, those that have come included.
    pub fn total(&self) -> u64 {
        self.total
    }

    fn draw(&mut self, length: usize) {
        let Some((left, rng)) = &mut self.drawn else { return };
        self.done = *left == 0;
        *left = left.saturating_sub(1);
        self.at[0] = (rng.next_u64() % (self.bits - length + 1) as u64) as usize;
        self.inner = (rng.next_u64() % (1 << length.saturating_sub(2))) as u32;
    }

    fn advance_flips(&mut self, flips: usize) {
        // The last position that can still move; those behind it follow closely.
        let movable = (0..flips).rev().find(|index| self.at[*index] < self.bits - flips + index);
        let Some(index) = movable else {
            self.done = true;
            return;
        };
        self.at[index] += 1;
        for later in index + 1..flips {
            self.at[later] = self.at[later - 1] + 1;
        }
    }

    fn advance_burst(&mut self, length: usize) {
        if self.drawn.is_some() {
            return self.draw(length);
        }
        self.inner += 1;
        if self.inner >> length.saturating_sub(2) != 0 {
            self.inner = 0;
            self.at[0] += 1;
            self.done = self.at[0] + length > self.bits;
        }
    }
}

impl Iterator for Corruptions {
    type Item = Mask;

    fn next(&mut self) -> Option<Mask> {
        if self.done {
            return None;
        }
        let mut mask = [0; MAX_SPDU];
        let mut invert = |bit: usize| mask[bit / 8] ^= 0x80 >> (bit % 8);
        match self.kind {
            Kind::Flips(flips) => {
                self.at[..flips].iter().for_each(|bit| invert(*bit));
                self.advance_flips(flips);
            }
            Kind::Burst(length) => {
                invert(self.at[0]);
                if length > 1 {
                    invert(self.at[0] + length - 1);
                }
                (0..length.saturating_sub(2))
                    .filter(|bit| self.inner >> bit & 1 != 0)
                    .for_each(|bit| invert(self.at[0] + 1 + bit));
                self.advance_burst(length);
            }
        }
        Some(mask)
    }
}

/// The bits a mask inverts, 0 being the most significant of the first octet.
pub fn bits(mask: &Mask) -> Vec<u16> {
    (0..8 * MAX_SPDU as u16).filter(|bit| mask[usize::from(bit / 8)] & 0x80 >> (bit % 8) != 0).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use fsct_protocol::ProtMode;
    use fsct_protocol::crc::Reading;
    use fsct_protocol::spdu::{Control, OutSpdu, Pd, Port, View};
    use rstest::rstest;
    use std::collections::BTreeSet;

    #[test]
    fn every_corruption_comes_once() {
        for (kind, octets) in
            [(1, 4), (2, 4), (3, 4), (4, 4), (5, 4)].map(|(flips, octets)| (Kind::Flips(flips), octets))
        {
            let all: Vec<Mask> = Corruptions::new(kind, octets).collect();
            assert_eq!(all.len() as u64, kind.count(octets), "{kind:?}");
            assert_eq!(all.iter().collect::<BTreeSet<_>>().len(), all.len(), "{kind:?}");
            let Kind::Flips(flips) = kind else { continue };
            assert!(all.iter().all(|mask| bits(mask).len() == flips && mask[octets..] == [0; MAX_SPDU][octets..]));
        }
    }

    #[test]
    fn bursts_are_as_long_as_they_should_be() {
        for length in 1..=10 {
            let all: Vec<Mask> = Corruptions::new(Kind::Burst(length), 4).collect();
            assert_eq!(all.len() as u64, Kind::Burst(length).count(4));
            for mask in &all {
                let bits = bits(mask);
                let (first, last) = (bits[0], bits[bits.len() - 1]);
                assert_eq!(usize::from(last - first) + 1, length);
            }
        }
        assert_eq!(Kind::Burst(40).count(4), 0);
    }

    #[test]
    fn drawn_bursts_are_bursts_of_that_length_anywhere_in_the_spdu() {
        let drawn = |seed| Corruptions::drawn(32, 7, 2_000, seed).map(|mask| bits(&mask)).collect::<Vec<_>>();
        let all = drawn(1);
        assert_eq!(all.len(), 2_000);
        assert!(all.iter().all(|bits| bits[bits.len() - 1] - bits[0] == 31));
        assert_eq!(all.iter().map(|bits| bits[0]).collect::<BTreeSet<_>>().len(), 25, "they start at every bit");
        assert!(all.iter().collect::<BTreeSet<_>>().len() > 1_990);
        assert_eq!((drawn(1), drawn(2) == all), (all, false));
        let few = Corruptions::drawn(3, 4, 1_000, 1);
        assert_eq!((few.total(), few.count() as u64), (60, Kind::Burst(3).count(4)));
    }

    /// Corruptions of a good SPDU that leave it a right signature.
    fn repaired(mode: ProtMode, pd: usize, all: impl Fn(usize) -> Corruptions) -> usize {
        let pd = Pd::new(&vec![0xA5; pd]).expect("not too long");
        let control = Control { mcount: 3, set_sd: false, ch_f_ack_req: false };
        let good = OutSpdu { pd, port: Port::ONE, control }.wire().emit(mode, Reading::default());
        let good = good.octets();
        let is_right = |mask: &Mask| {
            let bad: Vec<u8> = good.iter().zip(mask).map(|(octet, mask)| octet ^ mask).collect();
            View::new(&bad, mode, pd.octets().len()).expect("as long").signature_matches(Reading::default())
        };
        all(good.len()).filter(is_right).count()
    }

    /// The signature stands behind what it secures, and its polynomial has a constant term: such a polynomial divides no burst
    /// shorter than itself.
    #[rstest]
    #[case(ProtMode::Crc16, 0, 16)]
    #[case(ProtMode::Crc16, 3, 16)]
    #[case(ProtMode::Crc32, 0, 32)]
    #[case(ProtMode::Crc32, 25, 32)]
    fn no_burst_up_to_the_length_of_the_signature_repairs_it(
        #[case] mode: ProtMode,
        #[case] pd: usize,
        #[case] longest: usize,
    ) {
        for length in 1..=longest {
            let drawn = |octets| Corruptions::drawn(length, octets, 4_000, 1);
            assert_eq!(repaired(mode, pd, drawn), 0, "{length}");
        }
    }

    #[test]
    fn a_burst_one_bit_longer_can_repair_it() {
        assert_ne!(repaired(ProtMode::Crc16, 3, |octets| Corruptions::new(Kind::Burst(17), octets)), 0);
    }

    #[test]
    fn there_are_as_many_corruptions_of_seven_octets_as_the_binomial_coefficients_say() {
        assert_eq!((1..=5).map(|flips| Kind::Flips(flips).count(7)).sum::<u64>(), 4_216_422);
    }
}
