//! What a campaign does to a DUT, as data: the unit of shrinking and of replay.

use fsct_adapters::{Role, Variant};
use fsct_protocol::{Edition, ProtMode};
use serde::{Deserialize, Serialize};
use std::fmt::Write as _;

/// First word of a file of actions; changes when an old reader would misread.
pub const SCHEMA: &str = "fsct-actions/1";

/// One action. Faults concern the SPDU the conformant partner sends at this point.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Action {
    /// So many exchanges without fault.
    Good(u32),
    /// Corruption: these bits are inverted, 0 being the most significant of the first octet.
    Corrupt(Vec<u16>),
    /// Unintended repetition: what the DUT got so many SPDUs ago, 0 being the last one.
    Repeat(u8),
    /// Incorrect sequence: the counter is so many steps ahead, with a good signature.
    Sequence(u8),
    /// Loss: the DUT gets nothing in so many cycles.
    Lose(u16),
    /// Unacceptable delay: the DUT goes on getting the last SPDU for so many cycles.
    Delay(u16),
    /// Insertion: these octets, in hexadecimal, come from somewhere else.
    Insert(String),
    /// Masquerade: made-up process data and these flags of the control or status octet, with the right counter and a
    /// repaired signature.
    Masquerade(u8),
    /// Loop-back: the DUT gets its own image.
    LoopBack,
    /// Misdirection: the SPDU is one for so many ports further on, with a good signature.
    OtherPort(u8),
    /// An input service of the application takes this value, in hexadecimal.
    Set(String, String),
}

impl Action {
    /// Class of the fault in the words of Table 27; `None` for what is no fault.
    pub const fn class(&self) -> Option<&'static str> {
        Some(match self {
            Action::Good(_) | Action::Set(..) => return None,
            Action::Corrupt(_) => "corruption",
            Action::Repeat(_) => "repetition",
            Action::Sequence(_) => "incorrect sequence",
            Action::Lose(_) => "loss",
            Action::Delay(_) => "delay",
            Action::Insert(_) => "insertion",
            Action::Masquerade(_) => "masquerade",
            Action::LoopBack => "loop-back",
            Action::OtherPort(_) => "other port",
        })
    }

    /// Simpler actions that may show the same, simplest first.
    pub fn simpler(&self) -> Vec<Action> {
        let smaller =
            |count: u32| [1, count / 2, count.saturating_sub(1)].into_iter().filter(move |n| (1..count).contains(n));
        match self {
            Action::Good(count) => smaller(*count).map(Action::Good).collect(),
            Action::Lose(count) => smaller((*count).into()).map(|count| Action::Lose(count as u16)).collect(),
            Action::Delay(count) => smaller((*count).into()).map(|count| Action::Delay(count as u16)).collect(),
            Action::Repeat(back) => smaller(u32::from(*back) + 1).map(|back| Action::Repeat(back as u8 - 1)).collect(),
            Action::Corrupt(bits) if bits.len() > 1 => (0..bits.len())
                .map(|left_out| {
                    let mut bits = bits.clone();
                    bits.remove(left_out);
                    Action::Corrupt(bits)
                })
                .collect(),
            _ => Vec::new(),
        }
    }
}

/// A list of actions with what has to be known to repeat it: the DUT is switched on and brought to operation, the actions
/// follow, and a conformant partner restores operation at the end.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Script {
    /// Role of the DUT.
    pub role: Role,
    /// What the DUT is to be.
    pub variant: Variant,
    /// Seed of the process data the partner sends.
    pub seed: u64,
    /// The actions.
    pub actions: Vec<Action>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Head {
    schema: String,
    role: String,
    edition: String,
    mode: String,
    pd_out: u8,
    pd_in: u8,
    seed: u64,
}

impl Script {
    /// The file: one JSON value a line, the head first, then the actions.
    pub fn to_text(&self) -> String {
        let Variant { edition, mode, pd_out, pd_in } = self.variant;
        let head = Head {
            schema: SCHEMA.to_owned(),
            role: self.role.to_string(),
            edition: edition.name().to_owned(),
            mode: mode.name().to_owned(),
            pd_out,
            pd_in,
            seed: self.seed,
        };
        let mut text = String::new();
        let lines = std::iter::once(serde_json::to_string(&head)).chain(self.actions.iter().map(serde_json::to_string));
        for line in lines.flatten() {
            let _ = writeln!(text, "{line}");
        }
        text
    }

    /// Reads a file of actions.
    ///
    /// # Errors
    /// One sentence with the line.
    pub fn parse(text: &str) -> Result<Script, String> {
        let mut lines = (1..).zip(text.lines()).filter(|(_, line)| !line.trim().is_empty());
        let (_, first) = lines.next().ok_or("the file is empty")?;
        let head: Head =
            serde_json::from_str(first).map_err(|error| format!("line 1 is no head of a list: {error}"))?;
        if head.schema != SCHEMA {
            return Err(format!("line 1: the schema `{}` is not known, {SCHEMA} is", head.schema));
        }
        let role = match head.role.as_str() {
            "device" => Role::Device,
            "master" => Role::Master,
            other => return Err(format!("line 1: the role `{other}` is neither device nor master")),
        };
        let edition: Edition =
            head.edition.parse().map_err(|_| format!("line 1: there is no edition `{}`", head.edition))?;
        let mode: ProtMode = head.mode.parse().map_err(|_| format!("line 1: there is no mode `{}`", head.mode))?;
        if usize::from(head.pd_out.max(head.pd_in)) > mode.max_pd() {
            return Err(format!("line 1: {mode} has at most {} octets of process data", mode.max_pd()));
        }
        let actions = lines
            .map(|(number, line)| {
                serde_json::from_str(line).map_err(|error| format!("line {number} is no action: {error}"))
            })
            .collect::<Result<_, _>>()?;
        let variant = Variant { edition, mode, pd_out: head.pd_out, pd_in: head.pd_in };
        Ok(Script { role, variant, seed: head.seed, actions })
    }
}

/// Octets from hexadecimal digits; `None` when they are none.
pub fn from_hex(text: &str) -> Option<Vec<u8>> {
    let digits: Vec<u8> = text.chars().map(|c| c.to_digit(16).map(|digit| digit as u8)).collect::<Option<_>>()?;
    digits.len().is_multiple_of(2).then(|| digits.chunks(2).map(|pair| pair[0] << 4 | pair[1]).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_list_is_read_as_it_was_written() {
        let script = Script {
            role: Role::Master,
            variant: Variant { edition: Edition::V1_1, mode: ProtMode::Crc16, pd_out: 0, pd_in: 3 },
            seed: u64::MAX,
            actions: vec![
                Action::Good(7),
                Action::Corrupt(vec![3, 9]),
                Action::LoopBack,
                Action::Insert("00FF".to_owned()),
                Action::Set("setSD_C".to_owned(), "01".to_owned()),
            ],
        };
        assert_eq!(Script::parse(&script.to_text()), Ok(script));
    }

    #[test]
    fn a_list_with_faults_is_refused_with_the_line() {
        let good = r#"{"schema":"fsct-actions/1","role":"device","edition":"v1.1","mode":"crc16","pd_out":1,"pd_in":1,"seed":1}"#;
        assert!(Script::parse("").is_err_and(|why| why.contains("empty")));
        assert!(Script::parse(&format!("{good}\n{{\"explode\":1}}")).is_err_and(|why| why.contains("line 2")));
        let large = good.replace("\"pd_in\":1", "\"pd_in\":9");
        assert!(Script::parse(&large).is_err_and(|why| why.contains("at most 3 octets")));
    }
}
