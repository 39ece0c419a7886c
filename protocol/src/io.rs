//! FS I/O data: where each value and each qualifier of a structure stands (Annex C, 11.4.9 Tables 34 to 36; v1.1 11.4.8).
//!
//! Booleans come first, eight to an octet, the first one in bit 0; only the last such octet may be partly filled, and what it
//! does not carry is 0. Then come the IntegerT(16), then the IntegerT(32), two's complement, most significant octet first.

use crate::ProtMode;
use crate::fsp::{IoStructure, IoTotals};
use core::ops::Range;

/// IO_DescVersion of the structures there are (Table A.4).
const DESC_VERSION: u8 = 1;

impl IoStructure {
    /// A structure with these values in and out; `None` when one direction does not fit into an SPDU of this mode.
    pub fn new(mode: ProtMode, input: IoValues, output: IoValues) -> Option<IoStructure> {
        Some(IoStructure { version: DESC_VERSION, input: input.totals(mode)?, output: output.totals(mode)? })
    }
}

/// How many values of each data type one direction carries.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq, Hash)]
pub struct IoValues {
    /// BooleanT.
    pub bits: u8,
    /// IntegerT(16).
    pub int16: u8,
    /// IntegerT(32).
    pub int32: u8,
}

impl IoValues {
    /// Octets that hold the Booleans, a partly filled one included.
    pub const fn bit_octets(self) -> usize {
        (self.bits as usize).div_ceil(8)
    }

    /// Octets of FS process data.
    pub const fn octets(self) -> usize {
        self.bit_octets() + 2 * self.int16 as usize + 4 * self.int32 as usize
    }

    /// The items of Table A.4 for this direction; `None` when an SPDU of this mode cannot carry so much (A.2.7).
    pub fn totals(self, mode: ProtMode) -> Option<IoTotals> {
        if self.octets() > mode.max_pd() {
            return None;
        }
        Some(IoTotals {
            range: u8::try_from(mode.spdu_octets(self.octets())).ok()?,
            bits: self.bits,
            octets: u8::try_from(self.bit_octets()).ok()?,
            int16: self.int16,
            int32: self.int32,
        })
    }

    /// The octet that is not filled, and those of its bits that are padding; `None` without padding (C.2).
    pub const fn padding(self) -> Option<(usize, u8)> {
        match self.bits % 8 {
            0 => None,
            used => Some((self.bit_octets() - 1, 0xFF << used)),
        }
    }

    /// Sets every padding bit to 0.
    pub fn clear_padding(self, data: &mut [u8]) {
        if let Some((at, bits)) = self.padding()
            && let Some(octet) = data.get_mut(at)
        {
            *octet &= !bits;
        }
    }

    /// Whether every padding bit is 0.
    pub fn padded(self, data: &[u8]) -> bool {
        self.padding().is_none_or(|(at, bits)| data.get(at).is_none_or(|octet| octet & bits == 0))
    }

    /// The Boolean `index`, from 0 on; `None` when there is none.
    pub fn boolean(self, data: &[u8], index: u8) -> Option<bool> {
        (index < self.bits).then_some(())?;
        data.get(usize::from(index / 8)).map(|octet| octet >> (index % 8) & 1 == 1)
    }

    /// Sets the Boolean `index`; `None` when there is none.
    pub fn set_boolean(self, data: &mut [u8], index: u8, value: bool) -> Option<()> {
        (index < self.bits).then_some(())?;
        let octet = data.get_mut(usize::from(index / 8))?;
        let bit = 1 << (index % 8);
        *octet = if value { *octet | bit } else { *octet & !bit };
        Some(())
    }

    /// The IntegerT(16) `index`, from 0 on; `None` when there is none.
    pub fn int16(self, data: &[u8], index: u8) -> Option<i16> {
        data.get(self.int16_at(index)?)?.try_into().ok().map(i16::from_be_bytes)
    }

    /// Sets the IntegerT(16) `index`; `None` when there is none.
    pub fn set_int16(self, data: &mut [u8], index: u8, value: i16) -> Option<()> {
        data.get_mut(self.int16_at(index)?)?.copy_from_slice(&value.to_be_bytes());
        Some(())
    }

    /// The IntegerT(32) `index`, from 0 on; `None` when there is none.
    pub fn int32(self, data: &[u8], index: u8) -> Option<i32> {
        data.get(self.int32_at(index)?)?.try_into().ok().map(i32::from_be_bytes)
    }

    /// Sets the IntegerT(32) `index`; `None` when there is none.
    pub fn set_int32(self, data: &mut [u8], index: u8, value: i32) -> Option<()> {
        data.get_mut(self.int32_at(index)?)?.copy_from_slice(&value.to_be_bytes());
        Some(())
    }

    fn int16_at(self, index: u8) -> Option<Range<usize>> {
        let start = self.bit_octets() + 2 * usize::from(index);
        (index < self.int16).then_some(start..start + 2)
    }

    fn int32_at(self, index: u8) -> Option<Range<usize>> {
        let start = self.bit_octets() + 2 * usize::from(self.int16) + 4 * usize::from(index);
        (index < self.int32).then_some(start..start + 4)
    }

    /// Integers of both lengths.
    const fn integers(self) -> usize {
        self.int16 as usize + self.int32 as usize
    }
}

/// An FS-Terminal: what it reads and what it drives, each value with a qualifier towards the FS-Master.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq, Hash)]
pub struct Terminal {
    /// DI and AI.
    pub input: IoValues,
    /// DO and AO.
    pub output: IoValues,
}

/// A category of values (Table 35), in the order of its qualifiers.
#[derive(Copy, Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Category {
    /// Digital inputs.
    Di,
    /// Analogue inputs.
    Ai,
    /// Digital outputs.
    Do,
    /// Analogue outputs.
    Ao,
}

impl Category {
    /// In the order of Table 36.
    pub const ALL: [Category; 4] = [Category::Di, Category::Ai, Category::Do, Category::Ao];
}

impl Terminal {
    /// Octets to the FS-Master: the values read, then the qualifiers of each category. Those to the FS-Device are the values
    /// driven alone, [`IoValues::octets`] of `output`.
    pub fn octets(&self) -> usize {
        self.input.octets() + Category::ALL.into_iter().map(|category| self.count(category).div_ceil(8)).sum::<usize>()
    }

    /// Octet and bit of the qualifier `index` of a category, from 0 on; `None` when there is none. A category without values
    /// takes no octet, the others move up.
    pub fn qualifier(&self, category: Category, index: usize) -> Option<(usize, u8)> {
        (index < self.count(category)).then_some(())?;
        let before = Category::ALL.into_iter().filter(|other| *other < category);
        let start = self.input.octets() + before.map(|other| self.count(other).div_ceil(8)).sum::<usize>();
        Some((start + index / 8, (index % 8) as u8))
    }

    fn count(&self, category: Category) -> usize {
        match category {
            Category::Di => self.input.bits.into(),
            Category::Ai => self.input.integers(),
            Category::Do => self.output.bits.into(),
            Category::Ao => self.output.integers(),
        }
    }
}
