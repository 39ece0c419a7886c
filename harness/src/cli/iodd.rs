//! `fsct iodd FILE`: is the FS part of an IODD sound, and what does it declare.

use super::{USAGE, fail, print};
use crate::trace::hex;
use fsct_iodd::{Declaration, Finding, Report, Severity, Signature, check, octets_of};
use fsct_protocol::Edition;
use fsct_reports::visible;
use serde_json::{Value, json};
use std::path::PathBuf;

/// Arguments of `fsct iodd`.
#[derive(clap::Args, Debug)]
pub struct Args {
    /// The XML file of the IODD
    #[arg(value_name = "FILE")]
    file: PathBuf,
    /// The edition it is written for: v1.1 or iec2022; without it the file tells
    #[arg(long)]
    edition: Option<Edition>,
    /// The octets behind both signatures as well
    #[arg(long)]
    octets: bool,
    /// One JSON document
    #[arg(long)]
    json: bool,
}

/// Runs the command; the result is the exit code.
pub fn run(args: &Args) -> u8 {
    let file = args.file.display().to_string();
    let report = match octets_of(&args.file).and_then(|octets| check(&octets, args.edition)) {
        Ok(report) => report,
        Err(reason) => return fail(USAGE, format!("{file}: {reason}")),
    };
    if args.json {
        print(ascii(&json(&file, &report).to_string()));
    } else {
        report.findings.iter().for_each(|finding| print(visible_lines(&block(&file, finding))));
        print(visible_lines(&summary(&file, &report, args.octets)));
    }
    if report.is_sound() { 0 } else { 1 }
}

/// JSON without a character that could move a cursor: beyond ASCII, which stands in strings alone, each is escaped.
fn ascii(json: &str) -> String {
    let mut out = String::with_capacity(json.len());
    for c in json.chars() {
        match c.is_ascii() {
            true => out.push(c),
            false => c.encode_utf16(&mut [0; 2]).iter().for_each(|unit| out += &format!("\\u{unit:04x}")),
        }
    }
    out
}

/// What is left when the text of the file cannot move a cursor: our own line breaks alone.
fn visible_lines(text: &str) -> String {
    text.lines().map(visible).collect::<Vec<_>>().join("\n")
}

fn block(file: &str, finding: &Finding) -> String {
    let Finding { rule, severity, clause, line, column, found, expected } = finding;
    let (found, expected) = (one_line(found), one_line(expected));
    format!(
        "{file}:{line}:{column}: {} {rule} ({clause})\n  found     {found}\n  expected  {expected}\n",
        severity.name()
    )
}

fn one_line(text: &str) -> String {
    text.replace(['\n', '\r'], " ")
}

fn summary(file: &str, report: &Report, octets: bool) -> String {
    let declared = &report.declaration;
    let mut lines = vec![
        format!("{file}: edition {}, {}", report.edition, report.because),
        signature("FSP_ParamDescCRC", &report.param_desc, declared.param_desc_crc, octets),
        signature("FSP_IO_StructCRC", &report.structure, declared.io_struct_crc.map(u32::from), octets),
    ];
    lines.extend(facts(declared).into_iter().map(|(name, value)| format!("{name:<20} {value}")));
    let count = |severity| report.findings.iter().filter(|finding| finding.severity == severity).count();
    let (errors, warnings) = (count(Severity::Error), count(Severity::Warning));
    let verdict = if report.is_sound() { "sound" } else { "not sound" };
    lines.push(format!("{verdict}: {errors} errors, {warnings} warnings"));
    lines.join("\n")
}

fn signature(name: &str, signature: &Result<Signature, String>, declared: Option<u32>, octets: bool) -> String {
    let declared = declared.map_or("nothing".to_owned(), |value| value.to_string());
    match signature {
        Ok(Signature { computed, octets: secured }) => {
            let behind = if octets { format!("\n  over {}", hex(secured)) } else { String::new() };
            format!("{name:<20} {computed} (0x{computed:X}) computed, {declared} declared{behind}")
        }
        Err(reason) => format!("{name:<20} cannot be computed: {reason}; {declared} declared"),
    }
}

/// The declaration as names and values.
fn facts(declared: &Declaration) -> Vec<(&'static str, String)> {
    let number =
        |value: Option<u16>, unit: &str| value.map_or("not declared".to_owned(), |value| format!("{value}{unit}"));
    let tens =
        |value: Option<u16>| value.map_or("not declared".to_owned(), |value| format!("{} ms", u32::from(value) * 10));
    let octets = |value: Option<u8>| value.map_or("not readable".to_owned(), |value| format!("{value} octets"));
    let range =
        declared.watchdog_range.map_or("no valid range".to_owned(), |(least, most)| format!("{least} to {most} ms"));
    let mode = declared.mode.map_or("not declared".to_owned(), |mode| format!("{} ({mode})", mode.code()));
    let mut facts = vec![
        ("FSP_ProtMode", mode),
        ("FSP_Watchdog", format!("{}, {range}", number(declared.watchdog, " ms"))),
        ("safety data in", octets(declared.pd_in)),
        ("safety data out", octets(declared.pd_out)),
    ];
    if declared.edition == Edition::Iec2022 {
        facts.extend([
            ("FSP_TimeToReady", tens(declared.time_to_ready)),
            ("FSP_MinShutDownTime", tens(declared.min_shut_down_time)),
            ("FSP_WCDT", number(declared.wcdt, " ms")),
            ("FSP_OFDT", number(declared.ofdt, " ms")),
        ]);
    }
    facts
}

fn json(file: &str, report: &Report) -> Value {
    let declared = &report.declaration;
    let signature = |signature: &Result<Signature, String>| match signature {
        Ok(signature) => json!({"computed": signature.computed, "octets": hex(&signature.octets)}),
        Err(reason) => json!({"reason": reason}),
    };
    let finding = |finding: &Finding| {
        json!({
            "rule": finding.rule, "severity": finding.severity.name(), "clause": finding.clause,
            "line": finding.line, "column": finding.column, "found": finding.found, "expected": finding.expected,
        })
    };
    json!({
        "file": file,
        "edition": report.edition.name(),
        "because": report.because,
        "sound": report.is_sound(),
        "FSP_ParamDescCRC": signature(&report.param_desc),
        "FSP_IO_StructCRC": signature(&report.structure),
        "declaration": {
            "FSP_ProtMode": declared.mode.map(|mode| mode.code()),
            "pd_in": declared.pd_in,
            "pd_out": declared.pd_out,
            "FSP_Watchdog": declared.watchdog,
            "FSP_Watchdog_range": declared.watchdog_range.map(|(least, most)| [least, most]),
            "FSP_IO_StructCRC": declared.io_struct_crc,
            "FSP_ParamDescCRC": declared.param_desc_crc,
            "FSP_TimeToReady_ms": declared.time_to_ready.map(|value| u32::from(value) * 10),
            "FSP_MinShutDownTime_ms": declared.min_shut_down_time.map(|value| u32::from(value) * 10),
            "FSP_WCDT_ms": declared.wcdt,
            "FSP_OFDT_ms": declared.ofdt,
        },
        "findings": report.findings.iter().map(finding).collect::<Vec<_>>(),
    })
}
