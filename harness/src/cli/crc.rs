//! `fsct crc`: the signature of octets, and what signatures are worth.

mod residual;

use super::{RIG, USAGE, fail, print};
use fsct_protocol::ProtMode;
use fsct_protocol::crc::{Reading, crc16, crc32, signature};

/// Arguments of `fsct crc`.
#[derive(clap::Args, Debug)]
pub struct Args {
    /// crc16 or crc32 [default: crc16; with --residual both]
    #[arg(long)]
    mode: Option<ProtMode>,
    /// Start value 0 and no zero-to-one step, as for parameter blocks
    #[arg(long, conflicts_with = "residual")]
    block: bool,
    /// Octets in hexadecimal: FS process data, PortNum, control or status octet
    #[arg(value_name = "OCTETS", required_unless_present = "residual", conflicts_with = "residual")]
    data: Vec<String>,
    /// In place of a signature: weight distributions, Hamming distance, residual error probability and properness, all exact
    #[arg(long)]
    residual: bool,
    #[command(flatten)]
    of: residual::Choice,
}

/// Runs the command; the result is the exit code.
pub fn run(args: &Args) -> u8 {
    if args.residual {
        return residual::run(args.mode, &args.of);
    }
    let digits: String = args.data.concat().chars().filter(|c| !c.is_whitespace()).collect();
    let octets: Option<Vec<u8>> = (digits.is_ascii() && digits.len().is_multiple_of(2))
        .then(|| (0..digits.len()).step_by(2).map(|at| u8::from_str_radix(&digits[at..at + 2], 16).ok()).collect())
        .flatten();
    let Some(octets) = octets else {
        return fail(USAGE, format!("`{}` is no even number of hexadecimal digits", args.data.join(" ")));
    };
    let mode = args.mode.unwrap_or(ProtMode::Crc16);
    let value = match (args.block, mode) {
        (false, mode) => signature(mode, Reading::Preset, &octets),
        (true, ProtMode::Crc16) => crc16(0, &octets).into(),
        (true, ProtMode::Crc32) => crc32(0, &octets),
    };
    print(format!("{value:0width$X}", width = 2 * mode.signature_octets()));
    0
}
