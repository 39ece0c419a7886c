//! What an IODD declares of its FS-Device: the values to hold against the product.

use crate::model::{Iodd, number};
use crate::serialise::totals;
use fsct_protocol::{Edition, ProtMode};

/// The declaration of an FS-Device. `None`: the file does not say, or says nothing readable.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Declaration {
    /// The edition the file was judged by.
    pub edition: Edition,
    /// The default of FSP_ProtMode.
    pub mode: Option<ProtMode>,
    /// FS process data towards the FS-Master, in octets, without the safety code.
    pub pd_in: Option<u8>,
    /// FS process data towards the FS-Device, in octets, without the safety code.
    pub pd_out: Option<u8>,
    /// The default of FSP_Watchdog in milliseconds.
    pub watchdog: Option<u16>,
    /// The least and the greatest FSP_Watchdog in milliseconds.
    pub watchdog_range: Option<(u16, u16)>,
    /// The default of FSP_IO_StructCRC.
    pub io_struct_crc: Option<u16>,
    /// The default of FSP_ParamDescCRC: 16 bit in v1.1, 32 in iec2022.
    pub param_desc_crc: Option<u32>,
    /// FSP_TimeToReady in units of 10 ms (iec2022).
    pub time_to_ready: Option<u16>,
    /// FSP_MinShutDownTime in units of 10 ms (iec2022).
    pub min_shut_down_time: Option<u16>,
    /// FSP_WCDT in milliseconds (iec2022).
    pub wcdt: Option<u16>,
    /// FSP_OFDT in milliseconds (iec2022).
    pub ofdt: Option<u16>,
}

impl Declaration {
    pub(crate) fn of(iodd: &Iodd<'_>, edition: Edition) -> Declaration {
        let short = |text: &str| number(text).and_then(|value| u16::try_from(value).ok());
        let protocol = |subindex| {
            iodd.variable(16897).and_then(|variable| variable.default_of(subindex)).and_then(|(_, text)| short(text))
        };
        let single = |index| match edition {
            Edition::V1_1 => None,
            Edition::Iec2022 => iodd.variable(index).and_then(|variable| variable.default).and_then(short),
        };
        let range = || {
            let item = iodd.variable(16897)?.data.item(3)?;
            let range = item.data.ranges.first()?;
            Some((short(range.lower)?, short(range.upper)?))
        };
        let pd = iodd.process_data.first();
        Declaration {
            edition,
            mode: protocol(2).and_then(|code| u8::try_from(code).ok()).and_then(ProtMode::from_code),
            pd_in: pd.and_then(|pd| Some(totals(&pd.input.as_ref()?.data)?.range)),
            pd_out: pd.and_then(|pd| Some(totals(&pd.output.as_ref()?.data)?.range)),
            watchdog: protocol(3),
            watchdog_range: range(),
            io_struct_crc: protocol(4),
            param_desc_crc: iodd
                .variable(16914)
                .and_then(|variable| number(variable.default?))
                .and_then(|value| u32::try_from(value).ok()),
            time_to_ready: single(16912),
            min_shut_down_time: single(16913),
            wcdt: single(16915),
            ofdt: single(16916),
        }
    }
}
