//! An FS-Device in front of a tester that plays FS-Master and technology.

use crate::{Counted, Subject};
use fsct_protocol::scl::Device;
use fsct_protocol::scl::Var;
use fsct_protocol::scl::device::{Readings, Received};
use fsct_protocol::spdu::{Control, Status, succ};

/// An SPDU, or none for too long. What is not named is 0.
#[derive(Copy, Clone, Debug, PartialEq, Eq, Hash)]
pub enum Input {
    /// The next counter, 0 as the first.
    Next {
        /// setSD.
        set_sd: bool,
        /// SDset_DS while the answer is built.
        sdset_ds: bool,
    },
    /// MCount 0 with setSD, as after a timeout of the FS-Master; the next counter where 0 would be the previous once more.
    Zero,
    /// A counter that is neither the next nor 0 nor the previous.
    Jump,
    /// The next counter, a wrong signature.
    Corrupt,
    /// The counter of the SPDU processed last.
    Old,
    /// All octets 0.
    AllZero,
    /// No new SPDU until FSP_Watchdog has expired; in state 21 for longer than that.
    Timeout,
}

/// What comes of it: a new answer, and with it what the technology is given.
#[derive(Copy, Clone, Debug, PartialEq, Eq, Hash)]
pub struct Output {
    /// SDset.
    pub sd_set: bool,
    /// DCommErr.
    pub d_comm_err: bool,
    /// DTimeout.
    pub d_timeout: bool,
    /// PDout_D is live.
    pub pdout: bool,
    /// setSD_DC.
    pub set_sd_dc: bool,
}

/// The machine.
#[derive(Copy, Clone, Debug, PartialEq, Eq, Hash)]
pub struct Bench(pub Device);

impl Bench {
    /// Powered, waiting for the first SPDU.
    pub fn waiting(readings: Readings) -> Bench {
        let mut device = Device::new(readings);
        device.start();
        Bench(device.settled())
    }
}

const NEXT: Input = Input::Next { set_sd: false, sdset_ds: false };

impl Subject for Bench {
    type Input = Input;
    type Output = Option<Output>;

    const INPUTS: &'static [(&'static str, Input)] = &[
        ("NEXT", NEXT),
        ("NEXT+setSD", Input::Next { set_sd: true, sdset_ds: false }),
        ("NEXT+SDset_DS", Input::Next { set_sd: false, sdset_ds: true }),
        ("NEXT+setSD+SDset_DS", Input::Next { set_sd: true, sdset_ds: true }),
        ("MC0+setSD", Input::Zero),
        ("JUMP", Input::Jump),
        ("BADCRC", Input::Corrupt),
        ("OLD", Input::Old),
        ("ZERO", Input::AllZero),
        ("TIMEOUT", Input::Timeout),
    ];

    fn apply(&mut self, input: Input) -> Option<Output> {
        let Bench(device) = self;
        let next = device.previous().map_or(0, succ);
        let spdu = |mcount, set_sd, intact| {
            Some(Received { control: Control { mcount, set_sd, ch_f_ack_req: false }, intact })
        };
        device.set_sdset_ds(matches!(input, Input::Next { sdset_ds: true, .. }));
        let received = match input {
            Input::Next { set_sd, .. } => spdu(next, set_sd, true),
            Input::Zero => spdu(if device.previous() == Some(0) { next } else { 0 }, true, true),
            Input::Jump => spdu(succ(succ(next)), false, true),
            Input::Corrupt => spdu(next, false, false),
            Input::Old => device.previous().and_then(|mcount| spdu(mcount, false, true)),
            Input::AllZero | Input::Timeout => None,
        };
        let path = match (input, received) {
            (Input::Timeout, _) => device.expire(),
            (_, Some(received)) => device.receive(received),
            (_, None) => Default::default(),
        };
        let status = device.status();
        let (pdout, set_sd_dc) = (device.uses_pdout(), device.get(Var::SetSdDc) == 1);
        *device = device.settled();
        let Status { sd_set, d_comm_err, d_timeout, .. } = status;
        (!path.is_empty()).then_some(Output { sd_set, d_comm_err, d_timeout, pdout, set_sd_dc })
    }
}

impl Counted for Bench {
    type Seen = Output;

    fn counter(&self) -> u8 {
        self.0.status().dcount_i
    }
}
