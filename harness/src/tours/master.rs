//! What a scripted FS-Device, an operator and a gateway do to an FS-Master on a tour, and what the SPDU has to be.

use super::Subject;
use super::emit::{Told, wait};
use fsct_adapters::Role;
use fsct_protocol::scl::master::Answer;
use fsct_protocol::scl::{Master, Path, Var};
use fsct_protocol::spdu::{Status, inv3, succ};

/// An answer with what the gateway sets meanwhile, or none for too long.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Stimulus {
    /// A good answer.
    Good {
        /// SDset.
        sd_set: bool,
        /// ChFAck_C.
        ack: bool,
        /// setSD_C.
        set_sd: bool,
    },
    /// The FS-Device reports a timeout.
    Dtimeout,
    /// The FS-Device reports a CommErr.
    DcommErr,
    /// The mirrored counter, a bit of this field inverted.
    Corrupt(&'static str),
    /// From another port.
    Plain,
    /// A counter that mirrors nothing.
    Foreign,
    /// The counter of the answer before.
    Same,
    /// This DCount_i with the octets of the answer before.
    Again(u8),
    /// All octets 0.
    AllZero,
    /// No answer at all for an exchange.
    Nothing,
    /// Nothing but this until MTimer has expired.
    Timeout(&'static str),
}

use Stimulus::{Again, AllZero, Corrupt, DcommErr, Dtimeout, Foreign, Good, Nothing, Plain, Same, Timeout};

/// The machine, and the counter of the answer before.
#[derive(Copy, Clone, PartialEq, Eq, Hash)]
pub struct Bench {
    master: Master,
    sent: Option<u8>,
}

impl Subject for Bench {
    type Stimulus = Stimulus;

    const ROLE: Role = Role::Master;
    const ALPHABET: &'static [Stimulus] = &[
        Good { sd_set: false, ack: false, set_sd: false },
        Dtimeout,
        Timeout("lost"),
        Corrupt("signature"),
        Good { sd_set: true, ack: false, set_sd: false },
        DcommErr,
        Timeout("zero"),
        Foreign,
        Good { sd_set: false, ack: false, set_sd: true },
        Plain,
        Corrupt("data"),
        Good { sd_set: false, ack: true, set_sd: false },
        Same,
    ];

    fn waiting() -> (Bench, Path) {
        let mut master = Master::new();
        let path = master.start();
        (Bench { master, sent: None }, path)
    }

    fn apply(&mut self, stimulus: Stimulus) -> (Path, bool) {
        let Bench { master, sent } = self;
        let mcount = master.control().mcount;
        let mirrored = inv3(mcount);
        let plain = Status { dcount_i: mirrored, sd_set: false, d_comm_err: false, d_timeout: false };
        let (ack, set_sd) = match stimulus {
            Good { ack, set_sd, .. } => (ack, set_sd),
            _ => (false, false),
        };
        master.set_ch_f_ack_c(ack);
        master.set_set_sd_c(set_sd);
        let answer = match stimulus {
            Good { sd_set, .. } => Answer { status: Status { sd_set, ..plain }, intact: true },
            Dtimeout => Answer { status: Status { sd_set: true, d_timeout: true, ..plain }, intact: true },
            DcommErr => Answer { status: Status { sd_set: true, d_comm_err: true, ..plain }, intact: true },
            Corrupt(_) | Plain => Answer { status: plain, intact: false },
            Foreign => Answer { status: Status { dcount_i: inv3(succ(succ(mcount))), ..plain }, intact: true },
            Same => match sent {
                Some(dcount_i) => Answer { status: Status { dcount_i: *dcount_i, ..plain }, intact: true },
                None => return (Path::default(), false),
            },
            Again(dcount_i) => Answer { status: Status { dcount_i, ..plain }, intact: true },
            AllZero | Nothing => return (Path::default(), false),
            Timeout(_) => return (master.expire(), false),
        };
        *sent = Some(answer.status.dcount_i);
        let path = master.receive(answer);
        (path, !path.is_empty() && master.get(Var::Faults) == 1)
    }
}

/// What is done, as a step of a case. `expiries` are those since the answer sent last.
fn action(stimulus: Stimulus, expiries: usize) -> String {
    match stimulus {
        Good { sd_set: false, .. } => "exchange: {}".to_owned(),
        Good { .. } => "exchange: {SDset: 1}".to_owned(),
        Dtimeout => "exchange: {SDset: 1, DTimeout: 1}".to_owned(),
        DcommErr => "exchange: {SDset: 1, DCommErr: 1}".to_owned(),
        Corrupt(field) => format!("exchange: {{corrupt: {field}}}"),
        Plain => "exchange: {PortNum: plain}".to_owned(),
        Foreign => "exchange: {DCount_i: +2}".to_owned(),
        Same => "exchange: {DCount_i: same, PDin: same}".to_owned(),
        Again(dcount_i) => format!("exchange: {{DCount_i: {dcount_i}, PDin: same}}"),
        AllZero => "exchange: {image: zero, repeat: 2}".to_owned(),
        Nothing => "exchange: {image: lost, repeat: 2}".to_owned(),
        Timeout(link) => wait(expiries.max(1), link),
    }
}

/// A sequence of stimuli as steps of a case. What a tolerance leaves free is not expected. `absolute`: counters as numbers.
pub fn steps(tour: &[Stimulus], absolute: bool) -> Vec<Told> {
    let (mut bench, _) = Bench::waiting();
    let mut expiries = 0;
    let (mut acked, mut stopped) = (false, false);
    let mut told = Vec::new();
    for stimulus in tour {
        let before = bench.master;
        let (path, error) = bench.apply(*stimulus);
        let master = &bench.master;
        let control = master.control();
        let expired = matches!(stimulus, Timeout(_));
        // An SPDU that looks like the one before does not show when it was made: the wait counts from the one seen first.
        expiries = match (expired, stimulus) {
            (true, _) if before.control() == control => expiries + 1,
            (true, _) => 1,
            (false, AllZero | Nothing) => expiries,
            (false, _) => 0,
        };
        let action = action(*stimulus, expiries);
        let mut set = Vec::new();
        if told.is_empty() {
            set.push("PDout_M: pattern".to_owned());
        }
        let (ack, set_sd) = (master.get(Var::ChFAckC) == 1, master.get(Var::SetSdC) == 1);
        if ack != acked {
            set.push(format!("ChFAck_C: {}", u8::from(ack)));
        }
        if set_sd != stopped {
            set.push(format!("setSD_C: {}", u8::from(set_sd)));
        }
        (acked, stopped) = (ack, set_sd);
        let before = if set.is_empty() { Vec::new() } else { vec![format!("app: {{{}}}", set.join(", "))] };
        let expect = match path.is_empty() {
            true => vec![
                "image: unchanged".to_owned(),
                "app.PDin_M: unchanged".to_owned(),
                format!("app.ChFAckReq_S: {}", master.get(Var::ChFAckReqS)),
            ],
            false => expected(master, &path, absolute),
        };
        told.push(Told { before, action, expect, path, error });
    }
    told
}

/// What is expected of an FS-Master that has gone this way, `absolute`: its counter as a number. What a tolerance leaves free is not.
pub fn expected(master: &Master, path: &Path, absolute: bool) -> Vec<String> {
    let took = |numbers: &[u8]| path.iter().any(|t| numbers.contains(&t.0));
    let (expired, restarted) = (took(&[8, 14]), took(&[11]));
    let control = master.control();
    let bit = u8::from;
    let data = |live: bool| if live { "live" } else { "safe" };
    let mcount = match (absolute, expired) {
        (true, _) => control.mcount.to_string(),
        (false, true) => "0".to_owned(),
        (false, false) => "next".to_owned(),
    };
    let mut expect = vec![
        format!("MCount: {mcount}"),
        format!("setSD: {}", bit(control.set_sd)),
        format!("ChFAckReq: {}", bit(control.ch_f_ack_req)),
    ];
    // A22: SDout may go with setSD 0 while the FS-Device shows SDset.
    let device_stopped = !expired && master.get(Var::SdsetRx) == 1;
    if !(device_stopped && master.uses_pdout()) {
        expect.push(format!("PDout: {}", data(master.uses_pdout())));
    }
    // A14: PDin may be one cycle late after T11.
    if !restarted {
        expect.push(format!("app.PDin_M: {}", data(master.get(Var::In) == 1)));
        expect.push(format!("app.SDset_S: {}", master.get(Var::SdsetS)));
        expect.push(format!("app.qualifier: {}", if master.get(Var::SdsetS) == 1 { "BAD" } else { "GOOD" }));
    }
    expect.push(format!("app.ChFAckReq_S: {}", master.get(Var::ChFAckReqS)));
    expect
}

/// The tours.
pub fn tours() -> Vec<Vec<Told>> {
    super::tours::<Bench>().iter().map(|tour| steps(tour, false)).collect()
}
