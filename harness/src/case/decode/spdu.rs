//! The SPDU of an `exchange`, as it goes to an FS-Device or to an FS-Master.

use super::{BITS, Decoder};
use crate::case::model::*;
use crate::problem::{Problem, suggestion};
use crate::tree::{Fields, Placed};
use crate::yaml::Node;
use fsct_adapters::Role;
use std::ops::Range;

/// How the fields of an SPDU are called, by the direction it goes.
struct SpduWords {
    count: &'static str,
    next: &'static str,
    pd: &'static str,
    /// Bits of the control or status octet with their numbers.
    bits: &'static [(u8, &'static str)],
    /// Number of the lowest reserved bit, and the most its bits can hold.
    reserved: (u8, u64),
    other_port: &'static str,
    signatures: &'static [(Signature, &'static str)],
    fields: &'static [(Field, &'static str)],
}

const TO_DEVICE: SpduWords = SpduWords {
    count: "MCount",
    next: "next",
    pd: "PDout",
    bits: &[(1, "setSD"), (0, "ChFAckReq")],
    reserved: (2, 7),
    other_port: "inverted",
    signatures: &[
        (Signature::Good, "good"),
        (Signature::Zero, "zero"),
        (Signature::Inverted, "inverted"),
        (Signature::StartZero, "start-0"),
        (Signature::Reversed, "reversed"),
        (Signature::Order, "control-first"),
    ],
    fields: &[
        (Field::Data, "data"),
        (Field::PortNum, "PortNum"),
        (Field::Control, "control"),
        (Field::Signature, "signature"),
    ],
};

const TO_MASTER: SpduWords = SpduWords {
    count: "DCount_i",
    next: "mirror",
    pd: "PDin",
    bits: &[(2, "SDset"), (1, "DCommErr"), (0, "DTimeout")],
    reserved: (3, 3),
    other_port: "plain",
    signatures: &[
        (Signature::Good, "good"),
        (Signature::Zero, "zero"),
        (Signature::Inverted, "inverted"),
        (Signature::StartZero, "start-0"),
        (Signature::Reversed, "reversed"),
        (Signature::Order, "status-first"),
    ],
    fields: &[
        (Field::Data, "data"),
        (Field::PortNum, "PortNum"),
        (Field::Control, "status"),
        (Field::Signature, "signature"),
    ],
};

impl Decoder<'_> {
    pub(super) fn exchange(&mut self, node: &Node) -> Exchange {
        let mut fields = Fields::new(self.source, node, "`exchange`", self.problems);
        let words: &SpduWords = match self.role {
            Role::Device => &TO_DEVICE,
            Role::Master => &TO_MASTER,
        };
        let count = fields.optional(words.count);
        let mut bits = 0;
        for (bit, name) in words.bits {
            bits |= u8::from(fields.optional_word(name, BITS).unwrap_or(false)) << bit;
        }
        let pd = fields.optional(words.pd);
        let port_num = fields.optional("PortNum");
        let (shift, most) = words.reserved;
        bits |= (fields.optional_number("reserved", 0..=most).unwrap_or(0) as u8) << shift;
        let signature = fields.optional_word("signature", words.signatures).unwrap_or(Signature::Good);
        let corrupt = fields.texts("corrupt");
        let image = fields.optional("image");
        let times = fields.optional_number("times", 1..=10_000_000);
        let nsr = fields.optional("NSR");
        let repeat = fields.optional_number("repeat", 1..=1_000_000).map(|count| count as u32);
        let until = fields.get("until");
        let within = fields.optional("within");
        fields.finish(self.problems);
        if times.is_some() && (until.is_some() || repeat.is_some()) || (repeat.is_some() && until.is_some()) {
            self.problem(&node.at, "`times`, `repeat` and `until` exclude each other");
        }
        let until_at = until.map(|node| node.at.clone());
        let until = until.map(|node| self.expectations(node)).unwrap_or_default();
        let within = self.scl_cycles(within);
        if let (Some(at), None) = (&until_at, within) {
            self.problem(at, "`until` needs `within`, such as `within: 2 SCL cycles`");
        }
        Exchange {
            count: count.and_then(|text| self.count(text, words)).unwrap_or(Count::Next),
            bits,
            pd: pd.and_then(|text| self.data(text)).unwrap_or(Data::Pattern),
            port_num: port_num.and_then(|text| self.port_num(text, words)).unwrap_or(PortNum::Own),
            signature,
            corrupt: self.corrupt(corrupt, words),
            image: image.and_then(|text| self.image(text)).unwrap_or(Image::Spdu),
            times: times.unwrap_or(1) as u32,
            until,
            within: within.unwrap_or(1),
            nsr: nsr.and_then(|(text, at)| self.octets(&text, &at)).unwrap_or_default(),
            repeat,
        }
    }

    fn count(&mut self, (text, at): Placed, words: &SpduWords) -> Option<Count> {
        match text.as_str() {
            next if next == words.next => Some(Count::Next),
            "same" => Some(Count::Same),
            _ => {
                let jump = text.strip_prefix('+').and_then(|more| more.parse().ok()).map(Count::Jump);
                let bit =
                    text.strip_prefix("bit ").and_then(|bit| bit.parse().ok()).filter(|bit| *bit <= 2).map(Count::Bit);
                let exact = text.parse().ok().filter(|count| *count <= 7).map(Count::Exactly);
                let found = jump.or(bit).or(exact);
                if found.is_none() {
                    let SpduWords { count, next, .. } = words;
                    self.problem(
                        &at,
                        format!("`{text}` is no {count}: {next}, same, +1 and so on, bit 0 to bit 2, or 0 to 7"),
                    );
                }
                found
            }
        }
    }

    pub(super) fn data(&mut self, (text, at): Placed) -> Option<Data> {
        match text.as_str() {
            "pattern" => Some(Data::Pattern),
            "safe" => Some(Data::Safe),
            "same" => Some(Data::Same),
            "zero-signature" => Some(Data::ZeroSignature),
            "profile" => Some(Data::Profile),
            _ => self.octets(&text, &at).map(Data::Exactly),
        }
    }

    pub(super) fn octets(&mut self, text: &str, at: &Range<usize>) -> Option<Vec<u8>> {
        let digits: Option<Vec<u8>> = text
            .chars()
            .filter(|c| !c.is_whitespace() && *c != '_')
            .map(|c| c.to_digit(16).map(|digit| digit as u8))
            .collect();
        let octets = digits
            .filter(|digits| digits.len() % 2 == 0 && digits.len() <= 464)
            .map(|digits| digits.chunks_exact(2).map(|pair| pair[0] << 4 | pair[1]).collect());
        if octets.is_none() {
            self.problem(at, format!("`{text}` is neither a known word nor hexadecimal octets such as `5A 01`"));
        }
        octets
    }

    fn port_num(&mut self, (text, at): Placed, words: &SpduWords) -> Option<PortNum> {
        match text.as_str() {
            "own" => Some(PortNum::Own),
            other if other == words.other_port => Some(PortNum::Inverted),
            "foreign" => Some(PortNum::Foreign),
            _ => match text.parse() {
                Ok(octet) => Some(PortNum::Exactly(octet)),
                Err(_) => {
                    self.problem(
                        &at,
                        format!("`{text}` is no PortNum: own, {}, foreign, or 0 to 255", words.other_port),
                    );
                    None
                }
            },
        }
    }

    fn corrupt(&mut self, texts: Vec<Placed>, words: &SpduWords) -> Corrupt {
        if let [(text, _)] = texts.as_slice()
            && let Some((field, _)) = words.fields.iter().find(|(_, word)| word == text)
        {
            return Corrupt::Field(*field);
        }
        let mut bits = Vec::new();
        for (text, at) in texts {
            match text.parse::<usize>() {
                Ok(bit) if bit < 8 * 31 => bits.push(bit),
                _ => {
                    let help = suggestion(&text, words.fields.iter().map(|(_, word)| *word));
                    let message = format!("`{text}` is neither a bit (0 to 247) nor a field");
                    self.problems.push(Problem::new(self.source, at, message).help(help));
                }
            }
        }
        if bits.is_empty() { Corrupt::Nothing } else { Corrupt::Bits(bits) }
    }

    fn image(&mut self, (text, at): Placed) -> Option<Image> {
        match text.as_str() {
            "SPDU" => Some(Image::Spdu),
            "zero" => Some(Image::Zero),
            "lost" => Some(Image::Lost),
            "echo" => Some(Image::Echo),
            "standard" => Some(Image::Standard),
            _ => match (super::ago(&text), text.strip_suffix(" ago")) {
                (Some(count), _) => Some(Image::Ago(count)),
                (None, Some(_)) => {
                    self.problem(
                        &at,
                        format!("`{text}`: SPDUs are kept from `0 ago`, the last one, to `{} ago`", KEPT - 1),
                    );
                    None
                }
                (None, None) => self.octets(&text, &at).map(Image::Exactly),
            },
        }
    }
}
