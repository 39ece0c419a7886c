//! The known answers as typed data. Unknown keys are errors, so that no answer is read past.

use fsct_protocol::ProtMode;
use serde::Deserialize;
use serde::de::{Deserializer, Error as _};
use std::collections::BTreeMap;

const TEXT: &str = include_str!("../data/crc-vectors.yaml");

/// A text that holds no known answers.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LoadError(String);

impl std::fmt::Display for LoadError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "the known answers cannot be read: {}", self.0)
    }
}

impl std::error::Error for LoadError {}

/// The known answers this crate carries.
///
/// # Errors
/// [`LoadError`]; never for the file as it is committed, a test sees to that.
pub fn load() -> Result<Vectors, LoadError> {
    parse(TEXT)
}

/// Known answers from a text of the same form.
///
/// # Errors
/// [`LoadError`].
pub fn parse(text: &str) -> Result<Vectors, LoadError> {
    let budget = serde_saphyr::budget! { max_nodes: 50_000, max_events: 200_000, max_depth: 32, max_documents: 1 };
    let options = serde_saphyr::options! { budget: budget, strict_booleans: true };
    serde_saphyr::from_str_with_options(text, options).map_err(|error| LoadError(error.to_string()))
}

/// Octets, written in hexadecimal with blanks where the reader likes them.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Hex(pub Vec<u8>);

impl Hex {
    /// The octets as one number, most significant first.
    pub fn number(&self) -> u32 {
        self.0.iter().fold(0, |value, octet| value << 8 | u32::from(*octet))
    }
}

impl<'de> Deserialize<'de> for Hex {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let text = String::deserialize(deserializer)?;
        let digits: Option<Vec<u8>> =
            text.chars().filter(|c| *c != ' ').map(|c| c.to_digit(16).map(|digit| digit as u8)).collect();
        match digits {
            Some(digits) if digits.len() % 2 == 0 => Ok(Hex(digits
                .chunks_exact(2)
                .map(|pair| pair.iter().fold(0, |octet, digit| octet << 4 | digit))
                .collect())),
            _ => Err(D::Error::custom(format!("`{text}` is no hexadecimal octets"))),
        }
    }
}

/// Which signature.
#[derive(Copy, Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Crc {
    /// 0x4EAB.
    Crc16,
    /// 0xF4ACFB13.
    Crc32,
}

impl Crc {
    /// The FSP_ProtMode that uses it.
    pub const fn mode(self) -> ProtMode {
        match self {
            Crc::Crc16 => ProtMode::Crc16,
            Crc::Crc32 => ProtMode::Crc32,
        }
    }
}

/// Direction of an SPDU.
#[derive(Copy, Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Direction {
    /// FS-Master to FS-Device.
    Out,
    /// FS-Device to FS-Master.
    In,
}

/// The file.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Vectors {
    /// Version of the form: 1.
    pub format: u32,
    /// The two algorithms with their check values.
    pub algorithms: BTreeMap<Crc, Algorithm>,
    /// Where each start value applies: notes for the reader.
    #[serde(rename = "uses")]
    _uses: serde::de::IgnoredAny,
    /// Look-up tables, row by row.
    pub tables: BTreeMap<Crc, Vec<Vec<Hex>>>,
    /// Plain register runs without the zero-to-one step.
    pub raw: Vec<Raw>,
    /// Values that a document prints.
    pub printed: Vec<Printed>,
    /// FSP parameter blocks.
    pub blocks: Vec<Block>,
    /// FSP_ParamDescCRC.
    pub param_desc: Vec<ParamDesc>,
    /// SPDUs from their fields.
    pub spdu: Vec<Spdu>,
    /// SPDUs in a row.
    pub sequences: Vec<Sequence>,
    /// SPDUs whose computed signature is 0.
    pub zero_to_one: Vec<Spdu>,
    /// SPDUs whose computed signature is 1 by itself.
    pub raw_one: Vec<Spdu>,
    /// What a receiver has to decide.
    pub receive: Vec<Receive>,
    /// Error patterns that no signature finds: the negative control.
    pub undetectable: Vec<Undetectable>,
}

/// An algorithm with its check values.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Algorithm {
    /// Bits.
    pub width: u32,
    /// Generator without its highest term.
    pub poly: Hex,
    /// Octets enter least significant bit first: never.
    pub refin: bool,
    /// The register is reflected at the end: never.
    pub refout: bool,
    /// Inversion at the end: 0.
    pub xorout: u32,
    /// `msb_first`.
    pub octet_order_of_signature: String,
    /// Signature of "123456789" from 0.
    pub check_seed0: Hex,
    /// Signature of "123456789" from 1.
    pub check_seed1: Hex,
}

/// A register run.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Raw {
    /// Id.
    pub id: String,
    /// Signature.
    pub crc: Crc,
    /// Start value.
    pub seed: u32,
    /// Octets fed.
    pub data: Hex,
    /// Register afterwards.
    pub signature: Hex,
}

/// A value that a document prints.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Printed {
    /// Id.
    pub id: String,
    /// Edition, or `both`.
    pub edition: String,
    /// Where it stands.
    #[serde(rename = "where")]
    pub place: String,
    /// Signature.
    pub crc: Crc,
    /// Start value.
    pub seed: u32,
    /// Octets fed.
    pub data: Hex,
    /// Register afterwards.
    pub signature: Hex,
    /// The same as a decimal number.
    pub decimal: Option<u32>,
    /// Whether the document's value was reproduced.
    pub result: String,
    /// What the document prints where that differs.
    pub printed: Option<String>,
}

/// A parameter block.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Block {
    /// Id.
    pub id: String,
    /// Which block: `FSP_AuthentCRC`, `FSP_ProtParCRC`, `FSP_IO_StructCRC`, `FSP_VerifyRecord`.
    #[serde(rename = "use")]
    pub kind: String,
    /// Values as written, by name.
    pub fields: BTreeMap<String, String>,
    /// Octets fed.
    pub secured: Option<Hex>,
    /// Signature.
    pub signature: Option<Hex>,
    /// The block with its signature.
    pub block: Option<Hex>,
    /// Length of the block.
    pub octets: Option<usize>,
    /// What is special.
    pub note: Option<String>,
}

/// A parameter description.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "PascalCase")]
pub struct ParamDesc {
    /// Id.
    #[serde(rename = "id")]
    pub id: String,
    /// Edition.
    #[serde(rename = "edition")]
    pub edition: String,
    /// Default of FSP_ProtVersion.
    #[serde(rename = "ProtVersion_default")]
    pub version: u8,
    /// Default of FSP_ProtMode.
    #[serde(rename = "ProtMode_default")]
    pub mode: u8,
    /// Values of FSP_ProtMode.
    #[serde(rename = "ProtMode_values")]
    pub modes: Vec<u8>,
    /// Default of FSP_Watchdog.
    #[serde(rename = "Watchdog_default")]
    pub watchdog: u16,
    /// Range of FSP_Watchdog.
    #[serde(rename = "Watchdog_range")]
    pub watchdog_range: (u16, u16),
    /// Default of FSP_IO_StructCRC.
    #[serde(rename = "IO_StructCRC_default")]
    pub io_struct_crc: u16,
    /// Length of the stream.
    #[serde(rename = "octets")]
    pub octets: usize,
    /// The stream.
    #[serde(rename = "data")]
    pub data: Hex,
    /// Its signature.
    #[serde(rename = "signature")]
    pub signature: Hex,
    /// The same as a decimal number.
    #[serde(rename = "decimal")]
    pub decimal: u32,
}

/// Fields of an SPDU in either direction.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Fields {
    /// FS process data.
    pub fs_pd: Hex,
    /// FSP_Port.
    pub port: u8,
    /// MCount.
    #[serde(rename = "MCount")]
    pub mcount: Option<u8>,
    /// setSD.
    #[serde(rename = "SetSD")]
    pub set_sd: Option<u8>,
    /// ChFAckReq.
    #[serde(rename = "ChFAckReq")]
    pub ch_f_ack_req: Option<u8>,
    /// DCount_i.
    #[serde(rename = "DCount_i")]
    pub dcount_i: Option<u8>,
    /// SDset.
    #[serde(rename = "SDset")]
    pub sd_set: Option<u8>,
    /// DCommErr.
    #[serde(rename = "DCommErr")]
    pub d_comm_err: Option<u8>,
    /// DTimeout.
    #[serde(rename = "DTimeout")]
    pub d_timeout: Option<u8>,
}

/// An SPDU, or the statement that none exists.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Spdu {
    /// Id.
    pub id: String,
    /// Signature.
    pub crc: Crc,
    /// Direction.
    pub dir: Direction,
    /// Size in question where no such SPDU exists.
    pub fs_pd_octets: Option<usize>,
    /// Its fields.
    pub fields: Option<Fields>,
    /// Control or status octet.
    pub control_octet: Option<Hex>,
    /// Octets fed.
    pub secured: Option<Hex>,
    /// Register before the zero-to-one step.
    pub raw: Option<Hex>,
    /// Signature sent.
    pub signature: Option<Hex>,
    /// All octets, or `none`.
    #[serde(deserialize_with = "spdu_or_none")]
    pub spdu: Option<Hex>,
}

fn spdu_or_none<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<Hex>, D::Error> {
    let text = String::deserialize(deserializer)?;
    if text == "none" {
        return Ok(None);
    }
    Hex::deserialize(serde::de::value::StringDeserializer::new(text)).map(Some)
}

/// SPDUs in a row.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sequence {
    /// Id.
    pub id: String,
    /// The SPDUs.
    pub messages: Vec<Message>,
}

/// One SPDU of a sequence.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Message {
    /// Direction.
    pub dir: Direction,
    /// MCount.
    #[serde(rename = "MCount")]
    pub mcount: Option<u8>,
    /// setSD.
    #[serde(rename = "SetSD")]
    pub set_sd: Option<u8>,
    /// ChFAckReq.
    #[serde(rename = "ChFAckReq")]
    pub ch_f_ack_req: Option<u8>,
    /// DCount_i.
    #[serde(rename = "DCount_i")]
    pub dcount_i: Option<u8>,
    /// SDset.
    #[serde(rename = "SDset")]
    pub sd_set: Option<u8>,
    /// DCommErr.
    #[serde(rename = "DCommErr")]
    pub d_comm_err: Option<u8>,
    /// DTimeout.
    #[serde(rename = "DTimeout")]
    pub d_timeout: Option<u8>,
    /// All octets.
    pub spdu: Hex,
}

/// What a receiver decides.
#[derive(Copy, Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Expect {
    /// Signature and port are right.
    Accept,
    /// The signature is wrong.
    CrcError,
    /// The signature is right, PortNum is not.
    PortError,
    /// All octets 0.
    Ignore,
}

/// A received SPDU.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Receive {
    /// Id.
    pub id: String,
    /// Signature.
    pub crc: Crc,
    /// Direction.
    pub dir: Direction,
    /// FSP_Port of the receiver.
    pub port: u8,
    /// The octets.
    pub spdu: Hex,
    /// Decision.
    pub expect: Expect,
    /// Why.
    pub why: String,
}

/// An error pattern that leaves a signature valid.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Undetectable {
    /// Id.
    pub id: String,
    /// Signature.
    pub crc: Crc,
    /// Length of the SPDU.
    pub spdu_octets: usize,
    /// Bits of the pattern.
    pub weight: u32,
    /// The pattern.
    pub pattern: Hex,
}
