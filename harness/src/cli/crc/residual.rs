//! `fsct crc --residual`: what is computed, for whom; `table` and `figures` show it.

mod figures;
mod table;

use super::super::campaign::progress;
use super::{RIG, USAGE, fail, print};
use fsct_protocol::ProtMode;
use fsct_residual::{CRC_16, CRC_32, Code, Hump, MOST_OCTETS, Properness, Unsuitable, Weights, distributions};
use std::path::PathBuf;
use std::str::FromStr;

/// SPDUs and parameter blocks with their signatures, and the neighbours that figures and limits of Annex D name. Not the 81
/// octets of FSP_ParamDescCRC in iec2022, which would make every word of the enumeration three times as long.
const LENGTHS_16: &str = "3..8,11..13,16..18,79";
const LENGTHS_32: &str = "5..32";

/// Arguments that go with `--residual`.
#[derive(clap::Args, Debug)]
pub struct Choice {
    /// Octets of a word with its signature, such as 7 or 4..7,11
    #[arg(long = "octets", value_name = "FROM..TO,..", requires = "residual")]
    lengths: Option<Lengths>,
    /// Any other generator polynomial, highest term left out: 0x4EAB
    #[arg(long, value_name = "HEX", value_parser = polynomial, requires_all = ["residual", "width"], conflicts_with = "mode")]
    polynomial: Option<u32>,
    /// Bits of its signature, 2 to 32
    #[arg(long, value_name = "BITS", requires = "polynomial")]
    width: Option<u32>,
    /// One JSON document, with the weight distributions
    #[arg(long, requires = "residual")]
    json: bool,
    /// Draw the curves with the bounds of the standard
    #[arg(long, value_name = "FILE", requires = "residual")]
    svg: Option<PathBuf>,
}

/// Lengths, each once, the shortest first.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Lengths(Vec<usize>);

impl FromStr for Lengths {
    type Err = String;

    fn from_str(text: &str) -> Result<Lengths, String> {
        let length = |text: &str| text.trim().parse().ok().filter(|octets| (1..=MOST_OCTETS).contains(octets));
        let range = |text: &str| {
            let (from, upto) = text.split_once("..").unwrap_or((text, text));
            length(from).zip(length(upto.strip_prefix('=').unwrap_or(upto))).filter(|(from, upto)| from <= upto)
        };
        let ranges: Option<Vec<_>> = text.split(',').map(range).collect();
        let ranges = ranges.ok_or_else(|| format!("1 to {MOST_OCTETS} octets are meant, such as 7 or 4..7,11"))?;
        let mut lengths: Vec<usize> = ranges.into_iter().flat_map(|(from, upto)| from..=upto).collect();
        lengths.sort_unstable();
        lengths.dedup();
        Ok(Lengths(lengths))
    }
}

fn polynomial(text: &str) -> Result<u32, String> {
    let digits = text.strip_prefix("0x").or_else(|| text.strip_prefix("0X")).unwrap_or(text);
    let wrong = || "up to eight hexadecimal digits are meant, such as 0x4EAB".to_owned();
    // `from_str_radix` would take a sign.
    Some(digits)
        .filter(|digits| !digits.starts_with('+'))
        .and_then(|digits| u32::from_str_radix(digits, 16).ok())
        .ok_or_else(wrong)
}

/// A code at one length with all that takes a while to find.
struct Found {
    weights: Weights,
    properness: Properness,
    /// Looked for only where the code is not proper.
    hump: Option<Hump>,
}

/// A code at all lengths.
struct Survey {
    code: Code,
    found: Vec<Found>,
}

/// Runs the command; the result is the exit code. What the standard states and is not so is told, and is no failure: no product can
/// help it.
pub fn run(mode: Option<ProtMode>, args: &Choice) -> u8 {
    let surveys = match asked(mode, args).and_then(|asked| asked.into_iter().map(survey).collect::<Result<Vec<_>, _>>())
    {
        Ok(surveys) => surveys,
        Err(unsuitable) => return fail(USAGE, unsuitable),
    };
    if let Some(file) = &args.svg
        && let Err(error) = std::fs::write(file, figures::svg(&surveys))
    {
        return fail(RIG, format!("{} cannot be written: {error}", file.display()));
    }
    if args.json {
        print(figures::json(&surveys));
    } else {
        print(table::table(&surveys));
    }
    0
}

/// The codes with the lengths to look at, all sound.
fn asked(mode: Option<ProtMode>, args: &Choice) -> Result<Vec<(Code, Vec<usize>)>, Unsuitable> {
    let codes = match (args.width.zip(args.polynomial), mode) {
        (Some((width, polynomial)), _) => vec![Code::new(width, polynomial)?],
        (None, Some(ProtMode::Crc16)) => vec![CRC_16],
        (None, Some(ProtMode::Crc32)) => vec![CRC_32],
        (None, None) => vec![CRC_16, CRC_32],
    };
    let lengths = |code: Code| match &args.lengths {
        Some(lengths) => lengths.0.clone(),
        None => {
            let usual = if code.width() <= CRC_16.width() { LENGTHS_16 } else { LENGTHS_32 };
            let usual = usual.parse().unwrap_or(Lengths(Vec::new())).0;
            usual.into_iter().filter(|octets| code.check(*octets).is_ok()).collect()
        }
    };
    let asked: Vec<_> = codes.into_iter().map(|code| (code, lengths(code))).collect();
    asked.iter().try_for_each(|(code, lengths)| lengths.iter().try_for_each(|octets| code.check(*octets)))?;
    Ok(asked)
}

fn survey((code, lengths): (Code, Vec<usize>)) -> Result<Survey, Unsuitable> {
    let bar = progress(0);
    let weights = distributions(code, &lengths, &|done, all| {
        bar.set_length(all);
        bar.set_position(done);
    });
    bar.finish_and_clear();
    let found = |weights: Weights| {
        let properness = weights.properness();
        let hump = if properness == Properness::Proper { None } else { weights.hump() };
        Found { weights, properness, hump }
    };
    Ok(Survey { code, found: weights?.into_iter().map(found).collect() })
}

/// `CRC-16, polynomial 0x4EAB`.
fn name(code: Code) -> String {
    let digits = code.width().div_ceil(4) as usize;
    format!("CRC-{}, polynomial 0x{:0digits$X}", code.width(), code.polynomial())
}
