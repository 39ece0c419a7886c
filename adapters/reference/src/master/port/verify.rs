//! What the Safety Layer Manager verifies before the SCL of a port starts (10.4.3.1, Table B.2).

use crate::master::MasterMutant;
use crate::master::blocks::PortConfig;
use crate::master::scl::Config;
use fsct_protocol::spdu::Port;
use fsct_protocol::{Edition, ProtMode};

// Last digits of the EventCodes; those of v1.1 begin with 0xB00, those of iec2022 with 0x200.
const AUTHENTICATION_CODE: u16 = 3;
const AUTHENTICATION_PORT: u16 = 4;
const AUTHENT_CRC: u16 = 5;
const PROT_PAR_CRC: u16 = 6;
const WATCHDOG: u16 = 9;

/// Parameters that are in order.
#[derive(Copy, Clone, Debug)]
pub struct Verified {
    mode: ProtMode,
    pd_in: u8,
    pd_out: u8,
    port: Port,
    watchdog_ms: u16,
}

impl Verified {
    /// What the SCL starts with.
    pub const fn config(self, mutant: Option<MasterMutant>) -> Config {
        let Verified { mode, pd_in, pd_out, port, watchdog_ms } = self;
        Config { mode, pd_in, pd_out, port, watchdog_ms, mutant }
    }
}

/// The parameters of port `number`, or the EventCode of the first deviation.
///
/// Without authenticity from the upper-level system there is nothing to compare with. With FSP_TechParCRC 0 iec2022 does not
/// compare either. That edition has no EventCode for the port and the FS-Master takes FSP_Port as it is. What has no EventCode
/// in both editions, FSP_ProtVersion, FSP_ProtMode and lengths that do not go with it, is told as FSP_ProtParCRC.
pub fn verify(
    edition: Edition,
    number: u8,
    config: &PortConfig,
    fscp: Option<[u8; 8]>,
    mutant: Option<MasterMutant>,
) -> Result<Verified, u16> {
    let is = |fault: MasterMutant| mutant == Some(fault);
    let code = |digit: u16| match edition {
        Edition::Iec2022 if is(MasterMutant::VerifyEventOfV11) => 0xB000 + digit,
        Edition::V1_1 => 0xB000 + digit,
        Edition::Iec2022 => 0x2000 + digit,
    };
    let right = |right: bool, digit: u16| if right { Ok(()) } else { Err(code(digit)) };
    let (authenticity, protocol) = (&config.authenticity, &config.protocol);
    let compared = match protocol.tech_par_crc {
        0 => edition == Edition::V1_1 || is(MasterMutant::ArmedNotCompared),
        _ => !is(MasterMutant::ArmedNotCompared),
    };
    let mask = if is(MasterMutant::Authenticity2NotCompared) { !0 << 32 } else { !0 };
    let own = u64::from(authenticity.authenticity_1) << 32 | u64::from(authenticity.authenticity_2);
    let agrees = |fscp: [u8; 8]| u64::from_be_bytes(fscp) & mask == own & mask;
    let port_compared = edition == Edition::V1_1 && !is(MasterMutant::FspPortNotCompared);

    right(config.authent_crc_right || is(MasterMutant::AuthentCrcNotChecked), AUTHENT_CRC)?;
    right(config.prot_par_crc_right || is(MasterMutant::ProtParCrcNotChecked), PROT_PAR_CRC)?;
    right(protocol.watchdog_ms != 0 || is(MasterMutant::Watchdog0Accepted), WATCHDOG)?;
    right(!compared || fscp.is_none_or(agrees), AUTHENTICATION_CODE)?;
    right(!port_compared || authenticity.port == number, AUTHENTICATION_PORT)?;
    right(protocol.version == 1 || is(MasterMutant::ProtVersionNotChecked), PROT_PAR_CRC)?;
    let mode = ProtMode::from_code(protocol.mode).ok_or(code(PROT_PAR_CRC))?;
    let pd = |spdu: u8| {
        let pd = usize::from(spdu).checked_sub(mode.spdu_octets(0)).filter(|pd| *pd <= mode.max_pd());
        pd.and_then(|pd| u8::try_from(pd).ok()).ok_or(code(PROT_PAR_CRC))
    };
    Ok(Verified {
        mode,
        pd_in: pd(config.spdu_in)?,
        pd_out: pd(config.spdu_out)?,
        port: Port::new(authenticity.port).ok_or(code(AUTHENTICATION_PORT))?,
        watchdog_ms: protocol.watchdog_ms,
    })
}
