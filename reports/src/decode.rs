//! SPDUs of a record in words: field by field for the reader, short for charts.

use crate::machine::Machine;
use crate::record::VariantInfo;
use fsct_protocol::ProtMode;
use fsct_protocol::crc::Reading;
use fsct_protocol::spdu::View;

/// Which machine is under test, and so which way an SPDU went.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Side {
    /// The DUT is an FS-Device: it is sent output SPDUs and answers with input SPDUs.
    Device,
    /// The DUT is an FS-Master: the other way round.
    Master,
}

impl Side {
    /// The role as it stands in a record.
    pub fn of(role: &str) -> Side {
        if role == "master" { Side::Master } else { Side::Device }
    }

    /// Every transition of the machines of this side, by the names the record uses: the SCL's, and of an FS-Master the OSSDe
    /// qualifier handler's (Table 43).
    pub fn transitions(self) -> Vec<String> {
        let machines = Machine::ALL.into_iter().filter(|machine| machine.side() == self);
        machines.flat_map(Machine::transitions).collect()
    }

    /// What was sent to the DUT, field by field; `None` was lost on the way.
    pub fn sent(self, hex: Option<&str>, variant: &VariantInfo) -> String {
        match (hex, self) {
            (None, _) => "lost".to_owned(),
            (Some(hex), Side::Device) => out_spdu(hex, variant),
            (Some(hex), Side::Master) => in_spdu(hex, variant),
        }
    }

    /// What the DUT presented, field by field; `None` is no process data.
    pub fn got(self, hex: Option<&str>, variant: &VariantInfo) -> String {
        match (hex, self) {
            (None, _) => "no process data".to_owned(),
            (Some(hex), Side::Device) => in_spdu(hex, variant),
            (Some(hex), Side::Master) => out_spdu(hex, variant),
        }
    }

    /// What was sent to the DUT, short.
    pub fn sent_label(self, hex: Option<&str>, variant: &VariantInfo) -> String {
        match (hex, self) {
            (None, _) => "lost".to_owned(),
            (Some(hex), Side::Device) => out_label(hex, variant),
            (Some(hex), Side::Master) => in_label(hex, variant),
        }
    }

    /// What the DUT presented, short.
    pub fn got_label(self, hex: Option<&str>, variant: &VariantInfo) -> String {
        match (hex, self) {
            (None, _) => "no process data".to_owned(),
            (Some(hex), Side::Device) => in_label(hex, variant),
            (Some(hex), Side::Master) => out_label(hex, variant),
        }
    }
}

/// What can be said of an image.
enum Image<'o> {
    Zero,
    /// An SPDU, how its signature reads, and what follows it.
    Spdu(View<'o>, Reading, &'o [u8]),
    /// Octets an SPDU has, octets that are there.
    Other(usize, usize),
}

/// `PDout 5A 11 · PortNum 1 · MCount 3 · setSD 0 · ChFAckReq 0 · CRC ok`, for an SPDU to the FS-Device.
fn out_spdu(hex: &str, variant: &VariantInfo) -> String {
    told(hex, variant, variant.pd_out, |view| {
        let control = view.control();
        format!(
            "PDout {} · PortNum {:X} · MCount {} · setSD {} · ChFAckReq {}{}",
            octets(view.pd()),
            view.port_num(),
            control.mcount,
            u8::from(control.set_sd),
            u8::from(control.ch_f_ack_req),
            reserved(view.octet(), control.to_octet())
        )
    })
}

/// `PDin A5 · PortNum FE (=1 inverted) · DCount_i 4 · SDset 0 · DCommErr 0 · DTimeout 0 · CRC ok`, for an answer.
fn in_spdu(hex: &str, variant: &VariantInfo) -> String {
    told(hex, variant, variant.pd_in, |view| {
        let status = view.status();
        format!(
            "PDin {} · PortNum {:02X} (={:X} inverted) · DCount_i {} · SDset {} · DCommErr {} · DTimeout {}{}",
            octets(view.pd()),
            view.port_num(),
            !view.port_num(),
            status.dcount_i,
            u8::from(status.sd_set),
            u8::from(status.d_comm_err),
            u8::from(status.d_timeout),
            reserved(view.octet(), status.to_octet())
        )
    })
}

/// Reserved bits that are 1, as they stand in the octet; nothing when all are 0.
fn reserved(octet: u8, known: u8) -> String {
    match octet ^ known {
        0 => String::new(),
        bits => format!(" · reserved bits {bits:08b}"),
    }
}

/// `MCount 3 setSD SD`: counter, bits that are 1, and whether process data go along.
fn out_label(hex: &str, variant: &VariantInfo) -> String {
    label(hex, variant, variant.pd_out, |view| {
        let control = view.control();
        let mut text = format!("MCount {} setSD {}", control.mcount, u8::from(control.set_sd));
        flag(&mut text, control.ch_f_ack_req, "ChFAckReq");
        text
    })
}

/// `DCount_i 4 SDset DCommErr PD`: counter, bits that are 1, and whether process data go along.
fn in_label(hex: &str, variant: &VariantInfo) -> String {
    label(hex, variant, variant.pd_in, |view| {
        let status = view.status();
        let mut text = format!("DCount_i {} SDset {}", status.dcount_i, u8::from(status.sd_set));
        flag(&mut text, status.d_comm_err, "DCommErr");
        flag(&mut text, status.d_timeout, "DTimeout");
        text
    })
}

fn flag(text: &mut String, set: bool, name: &str) {
    if set {
        text.push(' ');
        text.push_str(name);
    }
}

fn told(hex: &str, variant: &VariantInfo, pd: u8, fields: impl Fn(&View<'_>) -> String) -> String {
    let Some(raw) = unhex(hex) else { return "no octets".to_owned() };
    match image(&raw, variant, pd) {
        Image::Zero => "all zero".to_owned(),
        Image::Other(expected, found) => format!("{found} octets, an SPDU has {expected}: {}", octets(&raw)),
        Image::Spdu(view, reading, rest) => {
            let rest = if rest.is_empty() { String::new() } else { format!(" · then {}", octets(rest)) };
            format!("{} · {}{rest}", fields(&view), crc(&view, reading, variant))
        }
    }
}

fn label(hex: &str, variant: &VariantInfo, pd: u8, fields: impl Fn(&View<'_>) -> String) -> String {
    let Some(raw) = unhex(hex) else { return "no octets".to_owned() };
    match image(&raw, variant, pd) {
        Image::Zero => "all zero".to_owned(),
        Image::Other(expected, found) => format!("{found} octets, not {expected}"),
        Image::Spdu(view, reading, _) => {
            let data = match view.pd() {
                [] => "",
                data if data.iter().all(|octet| *octet == 0) => " SD",
                _ => " PD",
            };
            let wrong = if view.signature_matches(reading) { "" } else { " CRC wrong" };
            format!("{}{data}{wrong}", fields(&view))
        }
    }
}

fn image<'o>(raw: &'o [u8], variant: &VariantInfo, pd: u8) -> Image<'o> {
    let reading = if variant.leading_octet { Reading::LeadingOctet } else { Reading::Preset };
    let length = mode(variant).spdu_octets(pd.into());
    match View::new(raw, mode(variant), pd.into()) {
        Ok(view) if view.is_all_zero() => Image::Zero,
        Ok(view) => Image::Spdu(view, reading, raw.get(length..).unwrap_or_default()),
        Err(error) => Image::Other(error.expected, error.found),
    }
}

fn crc(view: &View<'_>, reading: Reading, variant: &VariantInfo) -> String {
    let digits = 2 * mode(variant).signature_octets();
    match view.signature_matches(reading) {
        true => "CRC ok".to_owned(),
        false => format!("CRC wrong: {:0digits$X}, computed {:0digits$X}", view.signature(), view.computed(reading)),
    }
}

fn mode(variant: &VariantInfo) -> ProtMode {
    variant.mode.parse().unwrap_or(ProtMode::Crc16)
}

fn octets(octets: &[u8]) -> String {
    match octets {
        [] => "-".to_owned(),
        octets => octets.iter().map(|octet| format!("{octet:02X}")).collect::<Vec<_>>().join(" "),
    }
}

/// Octets of a hexadecimal text; `None` when it is none.
fn unhex(hex: &str) -> Option<Vec<u8>> {
    let digits: Option<Vec<u8>> = hex.chars().map(|c| c.to_digit(16).map(|digit| digit as u8)).collect();
    let digits = digits.filter(|digits| !digits.is_empty() && digits.len() % 2 == 0)?;
    Some(digits.chunks_exact(2).map(|pair| pair.iter().fold(0, |octet, digit| octet << 4 | digit)).collect())
}
