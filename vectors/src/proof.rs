//! Every known answer held against `fsct-protocol`, through its codecs and not the register alone.

use crate::data::{
    Block, Crc, Direction, Expect, Fields, Hex, Message, ParamDesc, Receive, Sequence, Spdu, Undetectable, Vectors,
};
use fsct_protocol::Edition;
use fsct_protocol::crc::{Reading, crc16, crc32, signature};
use fsct_protocol::fsp::{Authenticity, IoStructure, IoTotals, Protocol, VerifyRecord, param_desc_crc};
use fsct_protocol::spdu::{Control, InSpdu, OutSpdu, Pd, Port, Status, View};
use std::fmt;

/// An answer that was not reproduced.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Failure {
    /// Id of the answer.
    pub id: String,
    /// What the file says.
    pub expected: String,
    /// What the codec gives.
    pub found: String,
}

/// The answers of one section.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Section {
    /// Its name in the file.
    pub name: &'static str,
    /// Answers in it.
    pub answers: usize,
    /// Of these, statements that no such SPDU exists: they are proven by search in the tests, not here.
    pub statements: usize,
    /// Those not reproduced.
    pub failed: Vec<Failure>,
}

/// All sections. The 354 known answers are the entries of `raw`, `printed`, `blocks`, `param_desc`, `spdu`, `sequences`,
/// `zero_to_one`, `raw_one`, `receive` and `undetectable`; the look-up tables and check values come on top.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Score {
    /// Known answers.
    pub sections: Vec<Section>,
    /// Cells of the look-up tables and check values of the algorithms.
    pub tables: Section,
}

impl Score {
    /// Whether every answer was reproduced.
    pub fn is_proven(&self) -> bool {
        self.sections.iter().chain([&self.tables]).all(|section| section.failed.is_empty())
    }

    /// Known answers in all sections.
    pub fn answers(&self) -> usize {
        self.sections.iter().map(|section| section.answers).sum()
    }
}

impl fmt::Display for Score {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let failed: usize = self.sections.iter().map(|section| section.failed.len()).sum();
        for section in self.sections.iter().chain([&self.tables]) {
            let proven = section.answers - section.failed.len();
            write!(f, "{:<14} {:>4} of {:>4}", section.name, proven, section.answers)?;
            if section.statements > 0 {
                write!(f, "   ({} of them say that no such SPDU exists)", section.statements)?;
            }
            writeln!(f)?;
            for failure in &section.failed {
                writeln!(f, "  {}: expected {}, found {}", failure.id, failure.expected, failure.found)?;
            }
        }
        write!(f, "{} known answers: {} proven, {failed} failed", self.answers(), self.answers() - failed)
    }
}

/// Holds every answer against `fsct-protocol`.
pub fn prove(vectors: &Vectors) -> Score {
    let section = |name, checks: Vec<Option<Failure>>| Section {
        name,
        answers: checks.len(),
        statements: 0,
        failed: checks.into_iter().flatten().collect(),
    };
    let raw = vectors.raw.iter().map(|raw| check(&raw.id, &raw.signature, register(raw.crc, raw.seed, &raw.data.0)));
    let printed = vectors.printed.iter().map(|one| {
        let found = register(one.crc, one.seed, &one.data.0);
        let number = found.number();
        check(&one.id, &one.signature, found).or_else(|| check_number(&one.id, one.decimal.unwrap_or(number), number))
    });
    let mut zero = section("zero_to_one", vectors.zero_to_one.iter().map(spdu).collect());
    zero.statements = vectors.zero_to_one.iter().filter(|one| one.spdu.is_none()).count();
    Score {
        sections: vec![
            section("raw", raw.collect()),
            section("printed", printed.collect()),
            section("blocks", vectors.blocks.iter().map(block).collect()),
            section("param_desc", vectors.param_desc.iter().map(param_desc).collect()),
            section("spdu", vectors.spdu.iter().map(spdu).collect()),
            section("sequences", vectors.sequences.iter().map(sequence).collect()),
            zero,
            section("raw_one", vectors.raw_one.iter().map(spdu).collect()),
            section("receive", vectors.receive.iter().map(receive).collect()),
            section("undetectable", vectors.undetectable.iter().map(undetectable).collect()),
        ],
        tables: section("tables", tables(vectors)),
    }
}

fn text(octets: &[u8]) -> String {
    octets.iter().map(|octet| format!("{octet:02X}")).collect()
}

fn failure(id: &str, expected: impl ToString, found: impl ToString) -> Option<Failure> {
    Some(Failure { id: id.to_owned(), expected: expected.to_string(), found: found.to_string() })
}

fn check(id: &str, expected: &Hex, found: Hex) -> Option<Failure> {
    if *expected == found { None } else { failure(id, text(&expected.0), text(&found.0)) }
}

fn check_number<T: PartialEq + ToString>(id: &str, expected: T, found: T) -> Option<Failure> {
    if expected == found { None } else { failure(id, expected, found) }
}

/// The register after these octets, as octets.
fn register(crc: Crc, seed: u32, octets: &[u8]) -> Hex {
    Hex(match crc {
        Crc::Crc16 => crc16(seed as u16, octets).to_be_bytes().to_vec(),
        Crc::Crc32 => crc32(seed, octets).to_be_bytes().to_vec(),
    })
}

fn tables(vectors: &Vectors) -> Vec<Option<Failure>> {
    let mut checks = Vec::new();
    for (crc, rows) in &vectors.tables {
        let cells: Vec<&Hex> = rows.iter().flatten().collect();
        checks.push(check_number(&format!("{crc:?} cells"), 256, cells.len()));
        for (octet, cell) in (0..=255u8).zip(cells) {
            checks.push(check(&format!("{crc:?} cell {octet}"), cell, register(*crc, 0, &[octet])));
        }
    }
    for (crc, algorithm) in &vectors.algorithms {
        // One octet 01 from 0 leaves the generator in the register.
        checks.push(check(&format!("{crc:?} poly"), &algorithm.poly, register(*crc, 0, &[1])));
        checks.push(check(&format!("{crc:?} from 0"), &algorithm.check_seed0, register(*crc, 0, b"123456789")));
        checks.push(check(&format!("{crc:?} from 1"), &algorithm.check_seed1, register(*crc, 1, b"123456789")));
        checks.push(check_number(&format!("{crc:?} width"), algorithm.width, 8 * crc.mode().signature_octets() as u32));
    }
    checks
}

fn block(block: &Block) -> Option<Failure> {
    let hex = |name: &str| block.fields.get(name).and_then(|text| u32::from_str_radix(text, 16).ok()).unwrap_or(0);
    let number = |name: &str| block.fields.get(name).and_then(|text| text.parse::<u16>().ok()).unwrap_or(0);
    let octet = |name: &str| number(name) as u8;
    let octets = match block.kind.as_str() {
        "FSP_AuthentCRC" => Authenticity {
            authenticity_1: hex("FSP_Authenticity_1"),
            authenticity_2: hex("FSP_Authenticity_2"),
            port: octet("FSP_Port"),
        }
        .to_octets()
        .to_vec(),
        "FSP_ProtParCRC" => Protocol {
            version: octet("FSP_ProtVersion"),
            mode: octet("FSP_ProtMode"),
            watchdog_ms: number("FSP_Watchdog"),
            io_struct_crc: hex("FSP_IO_StructCRC") as u16,
            tech_par_crc: hex("FSP_TechParCRC"),
        }
        .to_octets()
        .to_vec(),
        "FSP_VerifyRecord" => {
            let expected = block.block.clone().unwrap_or_default();
            return match VerifyRecord::from_octets(&expected.0) {
                Ok(record) => check(&block.id, &expected, Hex(record.to_octets().to_vec())),
                Err(error) => failure(&block.id, text(&expected.0), error),
            };
        }
        _ => {
            let side = |range, way: &str| IoTotals {
                range: octet(range),
                bits: octet(&format!("TotalOf{way}Bits")),
                octets: octet(&format!("TotalOf{way}Octets")),
                int16: octet(&format!("TotalOf{way}Int16")),
                int32: octet(&format!("TotalOf{way}Int32")),
            };
            let structure = IoStructure {
                version: octet("IO_DescVersion"),
                input: side("InputDataRange", "In"),
                output: side("OutputDataRange", "Out"),
            };
            let expected = block.signature.clone().unwrap_or_default();
            return check(&block.id, &expected, Hex(structure.signature().to_be_bytes().to_vec()));
        }
    };
    let expected = block.block.clone().unwrap_or_default();
    let secured = block.secured.clone().unwrap_or_default();
    let sent = block.signature.clone().unwrap_or_default();
    check(&block.id, &expected, Hex(octets)).or_else(|| check(&block.id, &sent, register(Crc::Crc16, 0, &secured.0)))
}

fn param_desc(one: &ParamDesc) -> Option<Failure> {
    let edition = one.edition.parse().unwrap_or(Edition::V1_1);
    let found = param_desc_crc(edition, &one.data.0);
    check_number(&one.id, one.decimal, found)
        .or_else(|| check_number(&one.id, one.signature.number(), found))
        .or_else(|| check_number(&one.id, one.octets, one.data.0.len()))
}

fn bit(value: Option<u8>) -> bool {
    value == Some(1)
}

/// The SPDU of these fields on the line.
fn emit(crc: Crc, dir: Direction, fields: &Fields) -> Option<Vec<u8>> {
    let pd = Pd::new(&fields.fs_pd.0)?;
    let port = Port::new(fields.port)?;
    let wire = match dir {
        Direction::Out => {
            let control =
                Control { mcount: fields.mcount?, set_sd: bit(fields.set_sd), ch_f_ack_req: bit(fields.ch_f_ack_req) };
            OutSpdu { pd, port, control }.wire()
        }
        Direction::In => {
            let status = Status {
                dcount_i: fields.dcount_i?,
                sd_set: bit(fields.sd_set),
                d_comm_err: bit(fields.d_comm_err),
                d_timeout: bit(fields.d_timeout),
            };
            InSpdu { pd, port, status }.wire()
        }
    };
    Some(wire.emit(crc.mode(), Reading::Preset).octets().to_vec())
}

fn spdu(one: &Spdu) -> Option<Failure> {
    let (Some(expected), Some(fields)) = (&one.spdu, &one.fields) else {
        // "none": the size is named, no octets are.
        return check_number(&one.id, true, one.fs_pd_octets.is_some() && one.fields.is_none());
    };
    let found = Hex(emit(one.crc, one.dir, fields).unwrap_or_default());
    let secured = one.secured.clone().unwrap_or_default();
    let (raw, sent) = (one.raw.clone().unwrap_or_default(), one.signature.clone().unwrap_or_default());
    check(&one.id, expected, found)
        .or_else(|| check(&one.id, &raw, register(one.crc, 1, &secured.0)))
        .or_else(|| check_number(&one.id, sent.number(), signature(one.crc.mode(), Reading::Preset, &secured.0)))
}

fn sequence(one: &Sequence) -> Option<Failure> {
    // Port 1, CRC-16, one data octet, as the file says above it.
    one.messages.iter().find_map(|message| {
        let Message { dir, mcount, set_sd, ch_f_ack_req, dcount_i, sd_set, d_comm_err, d_timeout, spdu } = message;
        let fields = Fields {
            fs_pd: Hex(spdu.0.first().copied().into_iter().collect()),
            port: 1,
            mcount: *mcount,
            set_sd: *set_sd,
            ch_f_ack_req: *ch_f_ack_req,
            dcount_i: *dcount_i,
            sd_set: *sd_set,
            d_comm_err: *d_comm_err,
            d_timeout: *d_timeout,
        };
        check(&one.id, spdu, Hex(emit(Crc::Crc16, *dir, &fields).unwrap_or_default()))
    })
}

fn receive(one: &Receive) -> Option<Failure> {
    let mode = one.crc.mode();
    let Some(pd) = one.spdu.0.len().checked_sub(mode.spdu_octets(0)) else {
        return failure(&one.id, "an SPDU", "too few octets");
    };
    let found = match View::new(&one.spdu.0, mode, pd) {
        Err(_) => return failure(&one.id, "an SPDU", "too few octets"),
        Ok(view) if view.is_all_zero() => Expect::Ignore,
        Ok(view) if !view.signature_matches(Reading::Preset) => Expect::CrcError,
        Ok(view) => {
            let own = if one.dir == Direction::Out { one.port } else { !one.port };
            if view.port_num() == own { Expect::Accept } else { Expect::PortError }
        }
    };
    if found == one.expect { None } else { failure(&one.id, format!("{:?}", one.expect), format!("{found:?}")) }
}

fn undetectable(one: &Undetectable) -> Option<Failure> {
    let mode = one.crc.mode();
    let weight: u32 = one.pattern.0.iter().map(|octet| octet.count_ones()).sum();
    let pd = one.spdu_octets.saturating_sub(mode.spdu_octets(0));
    // Any valid SPDU will do whose signature is neither 0 nor 1 with and without the pattern.
    let fields = Fields { fs_pd: Hex(vec![0x5A; pd]), port: 1, mcount: Some(3), ..Fields::default() };
    let mut octets = emit(one.crc, Direction::Out, &fields).unwrap_or_default();
    octets.iter_mut().zip(&one.pattern.0).for_each(|(octet, error)| *octet ^= error);
    let valid = View::new(&octets, mode, pd).is_ok_and(|view| view.signature_matches(Reading::Preset));
    check_number(&one.id, one.weight, weight)
        .or_else(|| check_number(&one.id, one.spdu_octets, one.pattern.0.len()))
        .or_else(|| check_number(&one.id, true, valid))
}
