//! A technology parameter of an FS-Device as its profile tells it: `FST_index`, `FST_value` and `FST_other`.

use crate::tree::Fields;
use fsct_adapters::MAX_RECORD;
use std::ops::Range;

/// The feature of a profile that tells one.
pub const FEATURE: &str = "technology";

/// A technology parameter (FST) that can be written in commissioning and in an armed FS-Device.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Technology {
    /// Its Index; all of it is written, Subindex 0.
    pub index: u16,
    /// The value that FSP_TechParCRC_armed was made for.
    pub value: Vec<u8>,
    /// Another valid value.
    pub other: Vec<u8>,
}

impl Technology {
    /// Reads it from a profile; `at`: where that begins.
    pub fn read(fields: &mut Fields<'_>, at: &Range<usize>) -> Option<Technology> {
        let index = fields.optional_number("FST_index", 1..=0xFFFF);
        let mut octets = |key| {
            let (text, at) = fields.optional(key)?;
            let octets = octets_of(&text).filter(|octets| (1..=MAX_RECORD).contains(&octets.len()));
            if octets.is_none() {
                fields.problem(at, format!("`{key}` has to be 1 to {MAX_RECORD} octets such as `00 1F`, not `{text}`"));
            }
            octets
        };
        match (index, octets("FST_value"), octets("FST_other")) {
            (None, None, None) => None,
            (Some(index), Some(value), Some(other)) if value != other => {
                Some(Technology { index: index as u16, value, other })
            }
            _ => {
                fields.problem(at.clone(), "`FST_index`, `FST_value` and another `FST_other` go together");
                None
            }
        }
    }
}

fn octets_of(text: &str) -> Option<Vec<u8>> {
    text.split_whitespace().map(|octet| u8::from_str_radix(octet, 16).ok().filter(|_| octet.len() == 2)).collect()
}

#[cfg(test)]
mod tests {
    use crate::problem::{Problem, Source};
    use crate::profile::Profile;
    use rstest::rstest;
    use std::sync::Arc;

    fn profile(keys: &str) -> Result<Profile, Vec<Problem>> {
        let text = format!("profile: mine\ndut: device\n{keys}");
        Profile::parse(&Arc::new(Source { name: "mine.yaml".to_owned(), text }))
    }

    #[test]
    fn a_profile_that_tells_a_parameter_has_the_feature() {
        let told = profile("FST_index: 0x40\nFST_value: 00 01\nFST_other: 00 02\n").expect("it is sound");
        let technology = told.technology.expect("it was told");
        assert_eq!((technology.index, technology.value, technology.other), (0x40, vec![0, 1], vec![0, 2]));
        assert!(told.features.iter().any(|feature| feature == super::FEATURE));
    }

    #[rstest]
    #[case::part("FST_index: 0x40\n", "go together")]
    #[case::the_same("FST_index: 0x40\nFST_value: 00\nFST_other: 00\n", "go together")]
    #[case::no_octets("FST_index: 0x40\nFST_value: 0x00\nFST_other: 00\n", "has to be 1 to 232 octets")]
    fn half_of_it_is_a_problem(#[case] keys: &str, #[case] said: &str) {
        let problems = profile(keys).expect_err("it is not sound");
        assert!(problems.iter().any(|problem| problem.to_string().contains(said)), "{}", problems[0]);
    }
}
