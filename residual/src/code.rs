//! A CRC as a linear code.

/// Longest word that is looked at, signature included (Table D.1).
pub const MOST_OCTETS: usize = 128;

/// The CRC-16 of IO-Link Safety (Table D.1).
pub const CRC_16: Code = Code { width: 16, polynomial: 0x4EAB };
/// The CRC-32 of IO-Link Safety (Table D.1).
pub const CRC_32: Code = Code { width: 32, polynomial: 0xF4AC_FB13 };

/// Words whose last bits are the remainder of the others by a generator polynomial.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Code {
    width: u32,
    polynomial: u32,
}

/// Why there is no such code.
#[derive(Copy, Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Unsuitable {
    /// More bits than the enumeration can do, or too few for a signature.
    #[error("a signature has 2 to 32 bits here, not {0}")]
    Width(u32),
    /// The polynomial has more bits than the signature.
    #[error("polynomial 0x{polynomial:X} has more than {width} bits; write it without its highest term")]
    TooLarge {
        /// As given.
        polynomial: u32,
        /// Bits of the signature.
        width: u32,
    },
    /// Without the term 1 the last bit of the signature is of no use.
    #[error(
        "polynomial 0x{0:X} is even: a generator has the term 1; write it with its highest term left out, not reflected"
    )]
    Even(u32),
    /// No data, or more than is looked at.
    #[error(
        "a word has {least} to {MOST_OCTETS} octets with a signature of {width} bits, which is in them, not {octets}"
    )]
    Length {
        /// As given.
        octets: usize,
        /// The first length with room for data.
        least: usize,
        /// Bits of the signature.
        width: u32,
    },
}

impl Code {
    /// The code of a signature of `width` bits, 2 to 32, and a generator polynomial in the notation of Table D.1: highest term left
    /// out, the rest with the highest power first.
    ///
    /// # Errors
    /// [`Unsuitable`], without a length.
    pub const fn new(width: u32, polynomial: u32) -> Result<Code, Unsuitable> {
        if width < 2 || width > u32::BITS {
            return Err(Unsuitable::Width(width));
        }
        if width < u32::BITS && polynomial >> width != 0 {
            return Err(Unsuitable::TooLarge { polynomial, width });
        }
        if polynomial & 1 == 0 {
            return Err(Unsuitable::Even(polynomial));
        }
        Ok(Code { width, polynomial })
    }

    /// Bits of the signature.
    pub const fn width(self) -> u32 {
        self.width
    }

    /// The generator, highest term left out.
    pub const fn polynomial(self) -> u32 {
        self.polynomial
    }

    /// The shortest word that holds data, in octets.
    pub const fn least_octets(self) -> usize {
        self.width as usize / 8 + 1
    }

    /// Is there a word of so many octets, signature included?
    ///
    /// # Errors
    /// [`Unsuitable::Length`].
    pub const fn check(self, octets: usize) -> Result<(), Unsuitable> {
        if octets < self.least_octets() || octets > MOST_OCTETS {
            return Err(Unsuitable::Length { octets, least: self.least_octets(), width: self.width });
        }
        Ok(())
    }

    /// Do all code words have an even number of ones? They do when x + 1 divides the generator.
    pub(crate) const fn is_even(self) -> bool {
        // The term left out counts as well.
        self.polynomial.count_ones() % 2 == 1
    }

    /// x^j mod g for j = 0, 1, 2 ..: what one wrong bit, counted from the end, does to the signature.
    pub(crate) fn syndromes(self) -> impl Iterator<Item = u32> {
        let top = 1 << (self.width - 1);
        std::iter::successors(Some(1u32), move |&power| {
            // Of the bits above the width none is ever set.
            let shifted = (power & !top) << 1;
            Some(if power & top == 0 { shifted } else { shifted ^ self.polynomial })
        })
    }
}
