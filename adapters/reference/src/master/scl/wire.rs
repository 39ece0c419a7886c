//! The octets of an SPDU on the line (11.4): how the own one is composed, and the signature and PortNum of an answer.

use super::Config;
use crate::master::MasterMutant;
use fsct_protocol::ProtMode;
use fsct_protocol::crc::{Reading, crc16, crc32, signature};
use fsct_protocol::spdu::{Control, Emitted, Pd, View, Wire};

/// The own SPDU.
pub(super) fn emitted(config: &Config, pd: Pd, control: Control) -> Emitted {
    let port = config.port;
    let mut wire = Wire { pd, port_num: port.number(), octet: control.to_octet(), signature: None };
    let Control { mcount, set_sd, ch_f_ack_req } = control;
    match config.mutant {
        Some(MasterMutant::SetSdAndChFAckReqSwapped) => {
            wire.octet = Control { mcount, set_sd: ch_f_ack_req, ch_f_ack_req: set_sd }.to_octet();
        }
        Some(MasterMutant::McountBitsReversed) => {
            let mcount = mcount.reverse_bits() >> 5;
            wire.octet = Control { mcount, set_sd, ch_f_ack_req }.to_octet();
        }
        Some(MasterMutant::ReservedBitSent) => wire.octet |= 1 << 2,
        Some(MasterMutant::ChFAckReqBitMissing) => {
            wire.octet = Control { mcount, set_sd, ch_f_ack_req: false }.to_octet();
        }
        Some(MasterMutant::PortNumInvertedSent) => wire.port_num = port.inverted(),
        Some(MasterMutant::PortNumAlways1) => wire.port_num = 1,
        Some(MasterMutant::PdoutReversed) => {
            let reversed: Vec<u8> = pd.octets().iter().rev().copied().collect();
            wire.pd = Pd::new(&reversed).unwrap_or(pd);
        }
        _ => {}
    }
    wire.signature = Some(signed(config, wire.pd.octets(), [wire.port_num, wire.octet]));
    wire.emit(config.mode, Reading::Preset)
}

/// Whether the signature of the answer is right.
pub(super) fn signature_good(config: &Config, answer: &View<'_>) -> bool {
    let unsigned = config.mutant == Some(MasterMutant::ReservedBitsUnsigned);
    let status = if unsigned { answer.status().to_octet() } else { answer.octet() };
    let right = signed(config, answer.pd(), [answer.port_num(), status]);
    match config.mutant {
        Some(MasterMutant::LongestPdUnchecked) if answer.pd().len() == config.mode.max_pd() => true,
        Some(MasterMutant::SignatureLow16Bits) => right as u16 == answer.signature() as u16,
        _ => right == answer.signature(),
    }
}

/// Whether PortNum of the answer is right: on the way from the FS-Device it is inverted.
pub(super) fn port_num_good(config: &Config, answer: &View<'_>) -> bool {
    let (right, given) = (config.port.inverted(), answer.port_num());
    match config.mutant {
        Some(MasterMutant::PortNumNotChecked) => true,
        Some(MasterMutant::PortNumLowBits) => right & 0x0F == given & 0x0F,
        Some(MasterMutant::PlainPortNumAccepted) => right == given || config.port.number() == given,
        _ => right == given,
    }
}

/// The signature over process data, PortNum and the octet behind it.
fn signed(config: &Config, pd: &[u8], tail: [u8; 2]) -> u32 {
    let secured = [pd, &tail].concat();
    let crc = |seed: u16| match config.mode {
        ProtMode::Crc16 => crc16(seed, &secured).into(),
        ProtMode::Crc32 => crc32(seed.into(), &secured),
    };
    let right = signature(config.mode, Reading::Preset, &secured);
    match config.mutant {
        Some(MasterMutant::SignatureSeed0) => crc(0),
        Some(MasterMutant::ZeroSignatureKept) => crc(1),
        Some(MasterMutant::SignatureOctetsSwapped) if config.mode == ProtMode::Crc16 => {
            (right as u16).swap_bytes().into()
        }
        _ => right,
    }
}
