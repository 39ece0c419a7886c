//! The FS I/O structure a profile declares: `FS_IO_in` and `FS_IO_out`.

use crate::problem::Problem;
use crate::tree::Fields;
use fsct_adapters::{Description, Offer};
use fsct_protocol::ProtMode;
use fsct_protocol::fsp::IoStructure;
use fsct_protocol::io::IoValues;

/// The feature of a profile that declares the structure.
pub const DECLARED: &str = "FS_IO";
/// The feature of one whose FS-PDin has padding bits.
pub const PADDED: &str = "FS_IO padding";

/// What an FS-Device declares of its FS I/O data.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Declared {
    /// FS-PDin.
    pub input: IoValues,
    /// FS-PDout.
    pub output: IoValues,
}

impl Declared {
    /// Reads both keys of a profile; a direction that is left out carries nothing. `None` when both are.
    pub fn read(fields: &mut Fields<'_>, problems: &mut Vec<Problem>) -> Option<Declared> {
        let mut direction = |key: &'static str| {
            let node = fields.get(key)?;
            let before = problems.len();
            let mut counts = Fields::new(fields.source(), node, key, problems);
            let mut count = |key| counts.optional_number(key, 0..=200).unwrap_or(0) as u8;
            let values = IoValues { bits: count("bits"), int16: count("int16"), int32: count("int32") };
            if values.octets() > ProtMode::Crc32.max_pd() {
                let message = format!("`{key}` declares {} octets, an SPDU carries 25 at most", values.octets());
                counts.problem(node.at.clone(), message);
            }
            counts.finish(problems);
            (problems.len() == before).then_some(values)
        };
        match (direction("FS_IO_in"), direction("FS_IO_out")) {
            (None, None) => None,
            (input, output) => {
                Some(Declared { input: input.unwrap_or_default(), output: output.unwrap_or_default() })
            }
        }
    }

    /// What cases may be limited to.
    pub fn features(self) -> impl Iterator<Item = &'static str> {
        [Some(DECLARED), self.input.padding().map(|_| PADDED)].into_iter().flatten()
    }

    /// Octets of FS-PDout and FS-PDin.
    pub const fn sizes(self) -> (usize, usize) {
        (self.output.octets(), self.input.octets())
    }

    /// FSP_IO_StructCRC; `None` when the structure does not fit into the mode.
    pub fn signature(self, mode: ProtMode) -> Option<u16> {
        IoStructure::new(mode, self.input, self.output).map(|structure| structure.signature())
    }

    /// Whether a DUT offers these sizes in some mode.
    pub fn fits(self, description: &Description) -> bool {
        description.offers.iter().any(|offer| self.within(offer).is_some())
    }

    /// The offers with the declared sizes alone; an offer without them stays, and its variants are told as excluded.
    pub fn narrowed(self, offers: &[Offer]) -> Vec<Offer> {
        offers.iter().map(|offer| self.within(offer).unwrap_or(*offer)).collect()
    }

    fn within(self, offer: &Offer) -> Option<Offer> {
        let one = |(least, most): (u8, u8), size: usize| {
            u8::try_from(size).ok().filter(|size| (least..=most).contains(size)).map(|size| (size, size))
        };
        let (out, input) = self.sizes();
        Some(Offer { pd_out: one(offer.pd_out, out)?, pd_in: one(offer.pd_in, input)?, ..*offer })
    }
}

/// Why a case with this feature does not apply, in words that say what to declare.
pub fn term(feature: &str) -> Option<&'static str> {
    match feature {
        DECLARED => Some("the profile declares no FS I/O structure, neither `FS_IO_in` nor `FS_IO_out`"),
        PADDED => Some("the profile declares no FS-PDin with padding bits"),
        _ => None,
    }
}
