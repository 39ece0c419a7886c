//! The input of a fuzzer, read from its beginning. It never ends: behind its end there are zeros.

/// What is left of an input.
pub struct Input<'a>(&'a [u8]);

impl<'a> Input<'a> {
    pub fn new(octets: &'a [u8]) -> Input<'a> {
        Input(octets)
    }

    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    pub fn octet(&mut self) -> u8 {
        self.0.split_off_first().copied().unwrap_or(0)
    }

    /// Two octets.
    pub fn number(&mut self) -> u16 {
        u16::from_be_bytes([self.octet(), self.octet()])
    }

    /// As many octets as the next one says.
    pub fn octets(&mut self) -> Vec<u8> {
        let count = usize::from(self.octet());
        let there = self.0.split_off(..count.min(self.0.len())).unwrap_or_default();
        let mut octets = there.to_vec();
        octets.resize(count, 0);
        octets
    }
}
