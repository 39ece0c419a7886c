//! SPDUs of a record in words: field by field for the reader, short for charts.

use crate::record::VariantInfo;
use fsct_protocol::ProtMode;
use fsct_protocol::crc::Reading;
use fsct_protocol::spdu::View;

/// What can be said of an image.
enum Image<'o> {
    Zero,
    Spdu(View<'o>, Reading),
    Other(usize, usize),
}

/// `PDout 5A11 · PortNum 01 · MCount 3 · setSD 0 · ChFAckReq 0 · CRC ok`, for an SPDU to the FS-Device.
pub fn out_spdu(hex: &str, variant: &VariantInfo) -> String {
    told(hex, variant, variant.pd_out, |view| {
        let control = view.control();
        format!(
            "PDout {} · PortNum {:02X} · MCount {} · setSD {} · ChFAckReq {}",
            octets(view.pd()),
            view.port_num(),
            control.mcount,
            u8::from(control.set_sd),
            u8::from(control.ch_f_ack_req)
        )
    })
}

/// `PDin A5 · PortNum FE · DCount_i 4 · SDset 0 · DCommErr 0 · DTimeout 0 · CRC ok`, for an answer.
pub fn in_spdu(hex: &str, variant: &VariantInfo) -> String {
    told(hex, variant, variant.pd_in, |view| {
        let status = view.status();
        format!(
            "PDin {} · PortNum {:02X} · DCount_i {} · SDset {} · DCommErr {} · DTimeout {}",
            octets(view.pd()),
            view.port_num(),
            status.dcount_i,
            u8::from(status.sd_set),
            u8::from(status.d_comm_err),
            u8::from(status.d_timeout)
        )
    })
}

/// `MCount 3 setSD SD`: counter, bits that are 1, and whether process data go along.
pub fn out_label(hex: &str, variant: &VariantInfo) -> String {
    label(hex, variant, variant.pd_out, |view| {
        let control = view.control();
        let mut text = format!("MCount {}", control.mcount);
        flag(&mut text, control.set_sd, "setSD");
        flag(&mut text, control.ch_f_ack_req, "ChFAckReq");
        text
    })
}

/// `DCount_i 4 SDset DCommErr PD`: counter, bits that are 1, and whether process data go along.
pub fn in_label(hex: &str, variant: &VariantInfo) -> String {
    label(hex, variant, variant.pd_in, |view| {
        let status = view.status();
        let mut text = format!("DCount_i {}", status.dcount_i);
        flag(&mut text, status.sd_set, "SDset");
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
        Image::Spdu(view, reading) => format!("{} · {}", fields(&view), crc(&view, reading, variant)),
    }
}

fn label(hex: &str, variant: &VariantInfo, pd: u8, fields: impl Fn(&View<'_>) -> String) -> String {
    let Some(raw) = unhex(hex) else { return "no octets".to_owned() };
    match image(&raw, variant, pd) {
        Image::Zero => "all zero".to_owned(),
        Image::Other(_, found) => format!("{found} octets"),
        Image::Spdu(view, reading) => {
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
    if raw.iter().all(|octet| *octet == 0) {
        return Image::Zero;
    }
    let reading = if variant.leading_octet { Reading::LeadingOctet } else { Reading::Preset };
    match View::new(raw, mode(variant), pd.into()) {
        Ok(view) => Image::Spdu(view, reading),
        Err(error) => Image::Other(error.expected, error.found),
    }
}

fn crc(view: &View<'_>, reading: Reading, variant: &VariantInfo) -> String {
    let digits = 2 * mode(variant).signature_octets();
    match view.signature_matches(reading) {
        true => "CRC ok".to_owned(),
        false => format!("CRC {:0digits$X}, computed {:0digits$X}", view.signature(), view.computed(reading)),
    }
}

fn mode(variant: &VariantInfo) -> ProtMode {
    variant.mode.parse().unwrap_or(ProtMode::Crc16)
}

fn octets(octets: &[u8]) -> String {
    match octets {
        [] => "-".to_owned(),
        octets => octets.iter().map(|octet| format!("{octet:02X}")).collect(),
    }
}

/// Octets of a hexadecimal text; `None` when it is none.
fn unhex(hex: &str) -> Option<Vec<u8>> {
    let digits: Option<Vec<u8>> = hex.chars().map(|c| c.to_digit(16).map(|digit| digit as u8)).collect();
    let digits = digits.filter(|digits| !digits.is_empty() && digits.len() % 2 == 0)?;
    Some(digits.chunks_exact(2).map(|pair| pair.iter().fold(0, |octet, digit| octet << 4 | digit)).collect())
}
