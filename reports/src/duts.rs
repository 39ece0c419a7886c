//! The DUTs of a run by name: a report says which one a case is about as soon as there is a choice.

use crate::record::{CaseRecord, DutInfo, Header};
use crate::text::short;

/// Characters of a product in a label.
const PRODUCT: usize = 60;

/// The DUTs of a record.
#[derive(Copy, Clone)]
pub struct Duts<'r>(&'r [DutInfo]);

impl<'r> Duts<'r> {
    /// Those a header names.
    pub fn of(header: &'r Header) -> Duts<'r> {
        Duts(&header.duts)
    }

    /// The DUT a case is about; `None` when the header does not name it.
    pub fn get(self, number: usize) -> Option<&'r DutInfo> {
        self.0.get(number)
    }

    /// What tells this DUT from the others: `DUT 2 (Gateway 8)`, counted from 1. `None` when there is no other. Not escaped
    /// as markup, otherwise harmless.
    pub fn label(self, number: usize) -> Option<String> {
        let count = number.saturating_add(1);
        match (self.0, self.get(number)) {
            ([_], Some(_)) => None,
            (_, None) => Some(format!("DUT {count}, which the header does not name")),
            (_, Some(dut)) if dut.product.is_empty() => Some(format!("DUT {count}")),
            (_, Some(dut)) => Some(format!("DUT {count} ({})", short(&dut.product, PRODUCT))),
        }
    }

    /// The label of the DUT a case is about.
    pub fn of_case(self, case: &CaseRecord) -> Option<String> {
        self.label(case.dut)
    }
}
