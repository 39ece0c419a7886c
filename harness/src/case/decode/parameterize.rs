//! `parameterize`: the FSP records of the profile, and what is not as it says.

use super::Decoder;
use crate::case::model::{Parameterize, RecordField};
use crate::tree::Fields;
use crate::yaml::Node;

const WRITTEN: &[(bool, &str)] = &[(true, "written"), (false, "none")];
const BLOCKS: &[(bool, &str)] = &[(true, "written"), (false, "kept")];
const YES: &[(bool, &str)] = &[(true, "yes"), (false, "no")];

impl Decoder<'_> {
    pub(super) fn parameterize(&mut self, node: &Node) -> Parameterize {
        let mut fields = Fields::new(self.source, node, "`parameterize`", self.problems);
        let blocks = fields.optional_word("blocks", BLOCKS).unwrap_or(true);
        let record = fields.optional_word("record", WRITTEN).unwrap_or(true);
        let armed = fields.optional_word("armed", YES).unwrap_or(false);
        let starts = fields.optional_word("starts", YES).unwrap_or(true);
        let named: Vec<_> = RecordField::ALL
            .iter()
            .filter_map(|field| fields.optional(field.name).map(|placed| (field, placed)))
            .collect();
        fields.finish(self.problems);
        let set = named
            .into_iter()
            .filter_map(|(field, (text, at))| self.value(&text, &at).map(|value| (field, value)))
            .collect();
        Parameterize { blocks, record, armed, set, starts }
    }
}
