//! Which edition an IODD is written for, from what only one of them has.

use crate::model::Iodd;
use crate::text::Unreadable;
use fsct_protocol::Edition;

/// The edition and why.
///
/// # Errors
/// [`Unreadable::NoEdition`], [`Unreadable::TwoEditions`].
pub(crate) fn of(iodd: &Iodd<'_>) -> Result<(Edition, String), Unreadable> {
    let (mut v1_1, mut iec2022) = (Vec::new(), Vec::new());
    if let Some(variable) = iodd.variable(16914) {
        match variable.data.bits {
            Some(16) => v1_1.push("FSP_ParamDescCRC has 16 bit".to_owned()),
            Some(32) => iec2022.push("FSP_ParamDescCRC has 32 bit".to_owned()),
            _ => {}
        }
    }
    for index in [16912, 16913] {
        match iodd.variable(index).map(|variable| variable.data.kind) {
            Some("StringT") => v1_1.push(format!("Index {index} is a password")),
            Some("UIntegerT") => iec2022.push(format!("Index {index} is a time")),
            _ => {}
        }
    }
    for index in [16915, 16916] {
        if iodd.variable(index).is_some() {
            iec2022.push(format!("Index {index} is described"));
        }
    }
    match (v1_1.is_empty(), iec2022.is_empty()) {
        (false, true) => Ok((Edition::V1_1, v1_1.join(", "))),
        (true, false) => Ok((Edition::Iec2022, iec2022.join(", "))),
        (true, true) => Err(Unreadable::NoEdition),
        (false, false) => Err(Unreadable::two_editions(&v1_1, &iec2022)),
    }
}
