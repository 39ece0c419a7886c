//! What `fsct campaign` leaves: `campaign.json`, one document a campaign. On a virtual clock nothing in it depends on wall time.

use crate::record::DutInfo;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Name of the file in its folder.
pub const FILE: &str = "campaign.json";
/// Schema of [`Bits`].
pub const BITS: &str = "fsct-campaign-bits/2";
/// Schema of [`Random`].
pub const RANDOM: &str = "fsct-campaign-random/2";
/// Schema of [`Records`].
pub const RECORDS: &str = "fsct-campaign-record/2";

/// Schema of [`Noise`].
pub const NOISE: &str = "fsct-campaign-noise/1";

/// What every campaign says first.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Head {
    /// [`BITS`], [`RANDOM`], [`RECORDS`] or [`NOISE`].
    pub schema: String,
    /// Version of fsct.
    pub fsct: String,
    /// The seed that everything random derives from.
    pub seed: u64,
    /// The device under test.
    pub dut: DutInfo,
}

/// What came of the faults of one class.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Counts {
    /// Faults brought in.
    pub injected: u64,
    /// The SPDU was processed and answered as an error, or the watchdog expired.
    pub detected: u64,
    /// Left unprocessed, as the tables ask: nothing came, or nothing with another counter.
    pub dropped: u64,
    /// The falsified SPDU is a valid one in its place: no receiver can tell.
    pub valid: u64,
    /// The DUT did not do what the tables ask.
    pub failed: u64,
}

impl Counts {
    /// Adds others.
    pub fn add(&mut self, other: Counts) {
        self.injected += other.injected;
        self.detected += other.detected;
        self.dropped += other.dropped;
        self.valid += other.valid;
        self.failed += other.failed;
    }
}

/// Every corruption of an SPDU of some kind: `fsct campaign bits`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Bits {
    /// Schema, version, seed, DUT.
    #[serde(flatten)]
    pub head: Head,
    /// Corruptions that had to be detected.
    pub had_to_be_detected: u64,
    /// Upper bound of the fraction of such corruptions that go undetected, with 95 % confidence.
    pub undetected_fraction_at_most_95: f64,
    /// One row a kind of corruption and length.
    pub rows: Vec<BitsRow>,
    /// SPDUs that were corrupted and not detected, in hexadecimal.
    pub undetected: Vec<String>,
}

/// One kind of corruption at one length.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BitsRow {
    /// `v1.1` or `iec2022`.
    pub edition: String,
    /// `crc16` or `crc32`.
    pub mode: String,
    /// Octets of the SPDU.
    pub length: usize,
    /// Bits inverted, `2`, or the length of the bursts, `burst 16`.
    pub bits: String,
    /// What came of them.
    #[serde(flatten)]
    pub counts: Counts,
    /// Exchanges it took.
    pub exchanges: u64,
    /// As for the whole.
    pub undetected_fraction_at_most_95: f64,
    /// Whether all of them were tried.
    pub complete: bool,
}

/// Random faults of all classes: `fsct campaign random`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Random {
    /// Schema, version, seed, DUT.
    #[serde(flatten)]
    pub head: Head,
    /// Whether it came to its end.
    pub complete: bool,
    /// Starts of the DUT.
    pub episodes: u64,
    /// Exchanges.
    pub exchanges: u64,
    /// Classes of faults with what came of them.
    pub faults: BTreeMap<String, Counts>,
    /// Faults that had to be detected.
    pub had_to_be_detected: u64,
    /// Those that were not.
    pub undetected: u64,
    /// Upper bound of the fraction of such faults that go undetected, with 95 % confidence.
    pub undetected_fraction_at_most_95: f64,
}

/// Every corruption of FSP_VerifyRecord: `fsct campaign record`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Records {
    /// Schema, version, seed, DUT.
    #[serde(flatten)]
    pub head: Head,
    /// Whether it came to its end.
    pub complete: bool,
    /// One row a variant and number of bits.
    pub rows: Vec<RecordsRow>,
}

/// One number of inverted bits of one variant.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RecordsRow {
    /// Edition, mode, and how many of how many bits.
    pub variant: String,
    /// Bits inverted.
    pub flips: usize,
    /// Falsified records written.
    pub records: u64,
    /// Of these, refused instead of taken with an Event.
    pub refused: u64,
    /// The record that started the SCL, in hexadecimal; `None`: none did.
    pub failed: Option<String>,
}

/// Bits wrong by chance on the way to the DUT: `fsct campaign noise`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Noise {
    /// Schema, version, seed, DUT.
    #[serde(flatten)]
    pub head: Head,
    /// What each interval holds the true value with, 0 to 1.
    pub confidence: f64,
    /// One row a length and bit error probability.
    pub rows: Vec<NoiseRow>,
    /// What the DUT did with an SPDU that it judged against its signature; `None`: it judged all by it.
    pub failed: Option<String>,
}

/// One length at one bit error probability.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct NoiseRow {
    /// Octets of the SPDU.
    pub octets: usize,
    /// Probability that a bit is wrong.
    pub bit_error_probability: f64,
    /// SPDUs sent.
    pub spdus: u64,
    /// Those with at least one wrong bit.
    pub corrupted: u64,
    /// Of these, how many the DUT took for good.
    pub undetected: u64,
    /// Exchanges it took.
    pub exchanges: u64,
    /// Undetected of all SPDUs.
    pub measured: f64,
    /// Ends of the interval around it.
    pub interval: (f64, f64),
    /// The exact residual error probability.
    pub exact: f64,
}

impl NoiseRow {
    /// Whether the exact value lies in the interval.
    pub fn agrees(&self) -> bool {
        (self.interval.0..=self.interval.1).contains(&self.exact)
    }
}
