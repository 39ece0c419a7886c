//! All corruptions of an SPDU with so many bits inverted, or all bursts up to a length.

use fsct_protocol::spdu::MAX_SPDU;

/// Bits that are inverted, as octets to combine with an SPDU by exclusive or.
pub type Mask = [u8; MAX_SPDU];

/// The most bits a corruption can have here, and the longest burst.
pub const MAX_FLIPS: usize = 8;
/// The longest burst.
pub const MAX_BURST: usize = 24;

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
    done: bool,
}

impl Corruptions {
    /// Those of an SPDU of this many octets.
    pub fn new(kind: Kind, octets: usize) -> Corruptions {
        let mut at = [0; MAX_FLIPS];
        at.iter_mut().enumerate().for_each(|(index, place)| *place = index);
        Corruptions { kind, bits: 8 * octets, at, inner: 0, done: kind.count(octets) == 0 }
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
    fn there_are_as_many_corruptions_of_seven_octets_as_the_binomial_coefficients_say() {
        assert_eq!((1..=5).map(|flips| Kind::Flips(flips).count(7)).sum::<u64>(), 4_216_422);
    }
}
