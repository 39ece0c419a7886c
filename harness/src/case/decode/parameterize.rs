//! `parameterize`: the FSP records of the profile, and what is not as it says.

use super::Decoder;
use crate::case::model::{Blocks, Parameterize, RecordField, Sent, Starts};
use crate::tree::Fields;
use crate::yaml::Node;
use fsct_protocol::fsp::VerifyRecord;
use std::ops::Range;

const WRITTEN: &[(Sent, &str)] = &[(Sent::Written, "written"), (Sent::Swapped, "swapped"), (Sent::None, "none")];
const BLOCKS: &[(Blocks, &str)] =
    &[(Blocks::Written, "written"), (Blocks::Protocol, "protocol"), (Blocks::Kept, "kept")];
const YES: &[(bool, &str)] = &[(true, "yes"), (false, "no")];
const STARTS: &[(Starts, &str)] = &[(Starts::Yes, "yes"), (Starts::No, "no"), (Starts::Open, "open")];
const LONGER: &[(i8, &str)] = &[(-1, "-1"), (1, "1")];

impl Decoder<'_> {
    pub(super) fn parameterize(&mut self, node: &Node) -> Parameterize {
        let mut fields = Fields::new(self.source, node, "`parameterize`", self.problems);
        let blocks = fields.optional_word("blocks", BLOCKS).unwrap_or(Blocks::Written);
        let record = fields.optional_word("record", WRITTEN).unwrap_or(Sent::Written);
        let armed = fields.optional_word("armed", YES).unwrap_or(false);
        let starts = fields.optional_word("starts", STARTS).unwrap_or(Starts::Yes);
        let longer = fields.optional_word("longer", LONGER).unwrap_or(0);
        let bits = fields.texts("corrupt");
        let named: Vec<_> = RecordField::ALL
            .iter()
            .filter_map(|field| fields.optional(field.name).map(|placed| (field, placed)))
            .collect();
        fields.finish(self.problems);
        let set = named
            .into_iter()
            .filter_map(|(field, (text, at))| self.value(&text, &at).map(|value| (field, value)))
            .collect();
        let corrupt = bits.into_iter().filter_map(|(text, at)| self.record_bit(&text, &at)).collect();
        Parameterize { blocks, record, armed, set, corrupt, longer, starts }
    }

    fn record_bit(&mut self, text: &str, at: &Range<usize>) -> Option<usize> {
        const BITS: usize = 8 * VerifyRecord::OCTETS;
        let bit = text.parse().ok().filter(|bit| *bit < BITS);
        if bit.is_none() {
            self.problem(at, format!("`{text}` is no bit of FSP_VerifyRecord, 0 to {} are", BITS - 1));
        }
        bit
    }
}
