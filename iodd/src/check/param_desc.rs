//! IODD-47: FSP_ParamDescCRC.

use super::{Check, Signature, maybe};
use crate::model::number;

pub(super) fn check(check: &mut Check<'_, '_>, signature: &Result<Signature, String>) {
    let Some(variable) = check.variable(16914) else { return };
    let Some(text) = variable.default else { return };
    let found = format!("FSP_ParamDescCRC {}", maybe(Some(text)));
    match signature {
        Ok(signature) if number(text) == Some(signature.computed.into()) => {}
        Ok(signature) => {
            let expected = format!(
                "{} (0x{:X}), the signature over the parameter description",
                signature.computed, signature.computed
            );
            check.broken("IODD-47", variable.at, found, expected);
        }
        Err(reason) => {
            let expected = format!("a signature over the parameter description, which cannot be serialised: {reason}");
            check.broken("IODD-47", variable.at, found, expected);
        }
    }
}
