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
            (input, output) => Some(Declared { input: input.unwrap_or_default(), output: output.unwrap_or_default() }),
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

#[cfg(test)]
mod tests {
    use crate::problem::Source;
    use crate::profile::Profile;
    use fsct_protocol::ProtMode;
    use rstest::rstest;
    use std::sync::Arc;

    fn profile(dut: &str, rest: &str) -> Result<Profile, String> {
        let text = format!("profile: test\ndut: {dut}\n{rest}\n");
        let source = Arc::new(Source { name: "test.yaml".to_owned(), text });
        Profile::parse(&source).map_err(|problems| problems.iter().map(ToString::to_string).collect())
    }

    #[rstest]
    #[case::figure_a_1("FS_IO_in: {bits: 13, int16: 1}", (0, 4), Some(0x9A28), &["FS_IO", "FS_IO padding"])]
    #[case::no_padding("FS_IO_in: {bits: 8}\nFS_IO_out: {int16: 1}", (2, 1), None, &["FS_IO"])]
    #[case::nothing("FS_IO_in: {}", (0, 0), Some(0x5712), &["FS_IO"])]
    fn a_declaration_has_sizes_a_signature_and_features(
        #[case] declared: &str,
        #[case] sizes: (usize, usize),
        #[case] crc: Option<u16>,
        #[case] features: &[&str],
    ) {
        let profile = profile("device", declared).expect("a profile");
        let structure = profile.structure.expect("it is declared");
        assert_eq!(structure.sizes(), sizes);
        assert!(crc.is_none_or(|crc| structure.signature(ProtMode::Crc32) == Some(crc)));
        assert_eq!(profile.features, features);
    }

    #[test]
    fn what_an_spdu_of_the_mode_cannot_carry_has_no_signature() {
        let profile = profile("device", "FS_IO_in: {bits: 13, int16: 1}").expect("a profile");
        assert_eq!(profile.structure.and_then(|structure| structure.signature(ProtMode::Crc16)), None);
        assert!(profile.structure.is_some());
    }

    #[rstest]
    #[case("device", "FS_IO_in: {int32: 7}", "declares 28 octets, an SPDU carries 25 at most")]
    #[case("device", "FS_IO_in: {bit: 7}", "unknown key `bit` in FS_IO_in")]
    #[case("device", "FS_IO_out: {bits: 201}", "a number from 0 to 200")]
    #[case("device", "FS_IO_out: 3", "FS_IO_out has to be a map of keys")]
    #[case("master", "FS_IO_out: {bits: 8}", "are for an FS-Device")]
    #[case("device", "FS_PortMode: none", "is for an FS-Master")]
    #[case("master", "FS_PortMode: some", "is no value of `FS_PortMode`")]
    fn a_wrong_declaration_is_told(#[case] dut: &str, #[case] declared: &str, #[case] told: &str) {
        let problems = profile(dut, declared).expect_err("it is wrong");
        assert!(problems.contains(told), "{problems}");
    }
}
