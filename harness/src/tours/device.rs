//! What a scripted FS-Master does to an FS-Device on a tour, and what the answer has to be.

use super::Subject;
use super::emit::{Told, wait};
use fsct_adapters::Role;
use fsct_protocol::scl::device::{Readings, Received};
use fsct_protocol::scl::{Device, Path, State, T, Var};
use fsct_protocol::spdu::{Control, succ};

/// An SPDU, or none for too long.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Stimulus {
    /// The next counter.
    Next {
        /// setSD.
        set_sd: bool,
        /// ChFAckReq.
        ch_f_ack_req: bool,
        /// What the technology sets meanwhile.
        sdset_ds: bool,
    },
    /// As after a timeout of the FS-Master.
    Zero,
    /// The counter of the SPDU before.
    Same,
    /// The next counter, a bit of this field inverted.
    Corrupt(&'static str),
    /// Sent to another port.
    Foreign,
    /// A counter further on.
    Jump,
    /// All octets 0.
    AllZero,
    /// No SPDU at all for an exchange.
    Nothing,
    /// Nothing but this until DTimer has expired.
    Timeout(&'static str),
}

use Stimulus::{AllZero, Corrupt, Foreign, Jump, Next, Nothing, Same, Timeout, Zero};

const fn next(set_sd: bool, ch_f_ack_req: bool) -> Stimulus {
    Next { set_sd, ch_f_ack_req, sdset_ds: false }
}

/// The machine.
#[derive(Copy, Clone, PartialEq, Eq, Hash)]
pub struct Bench(Device);

impl Subject for Bench {
    type Stimulus = Stimulus;

    const ROLE: Role = Role::Device;
    const ALPHABET: &'static [Stimulus] = &[
        next(false, false),
        Corrupt("signature"),
        Timeout("lost"),
        Jump,
        next(true, false),
        Foreign,
        Timeout("zero"),
        next(false, true),
        Corrupt("data"),
        Zero,
        Same,
    ];

    fn waiting() -> (Bench, Path) {
        let mut device = Device::new(Readings::default());
        let path = device.start();
        (Bench(device), path)
    }

    fn apply(&mut self, stimulus: Stimulus) -> (Path, bool) {
        let Bench(device) = self;
        let next = device.previous().map_or(0, succ);
        let control = |mcount| Control { mcount, set_sd: false, ch_f_ack_req: false };
        let good = |control| Received { control, intact: true };
        device.set_sdset_ds(matches!(stimulus, Next { sdset_ds: true, .. }));
        let path = match stimulus {
            Next { set_sd, ch_f_ack_req, .. } => device.receive(good(Control { mcount: next, set_sd, ch_f_ack_req })),
            Zero => device.receive(good(Control { mcount: 0, set_sd: true, ch_f_ack_req: false })),
            Same => device.previous().map_or_else(Default::default, |mcount| device.receive(good(control(mcount)))),
            Corrupt(_) | Foreign => device.receive(Received { control: control(next), intact: false }),
            Jump => device.receive(good(control(succ(succ(next))))),
            Timeout(_) => device.expire(),
            AllZero | Nothing => Path::default(),
        };
        (path, !path.is_empty() && !matches!(stimulus, Timeout(_)) && device.get(Var::CommErr) == 1)
    }
}

/// What is done, as a step of a case. `expiries` are those since the SPDU sent last.
fn action(stimulus: Stimulus, expiries: usize) -> String {
    match stimulus {
        Next { set_sd: false, ch_f_ack_req: false, .. } => "exchange: {}".to_owned(),
        Next { set_sd: true, .. } => "exchange: {setSD: 1}".to_owned(),
        Next { .. } => "exchange: {ChFAckReq: 1}".to_owned(),
        Zero => "exchange: {MCount: 0, setSD: 1, PDout: safe}".to_owned(),
        Same => "exchange: {MCount: same, PDout: same, repeat: 2}".to_owned(),
        Corrupt(field) => format!("exchange: {{corrupt: {field}}}"),
        Foreign => "exchange: {PortNum: foreign}".to_owned(),
        Jump => "exchange: {MCount: +2}".to_owned(),
        AllZero => "exchange: {image: zero, repeat: 2}".to_owned(),
        Nothing => "exchange: {image: lost, repeat: 2}".to_owned(),
        Timeout(link) => wait(expiries, link),
    }
}

/// A sequence of stimuli as steps of a case. What a tolerance leaves free is not expected. `absolute`: counters as numbers.
pub fn steps(tour: &[Stimulus], absolute: bool) -> Vec<Told> {
    let (mut bench, _) = Bench::waiting();
    let mut expiries = 0;
    let (mut demanded, mut left) = (false, false);
    let mut told = Vec::new();
    for stimulus in tour {
        let before = bench.0;
        let (path, error) = bench.apply(*stimulus);
        let device = &bench.0;
        let expired = matches!(stimulus, Timeout(_));
        expiries = match (expired, path.is_empty()) {
            (true, _) => expiries + 1,
            (false, true) => expiries,
            (false, false) => 0,
        };
        let action = action(*stimulus, expiries);
        let demand = device.get(Var::SdsetDs) == 1;
        let set = (demand != demanded).then(|| format!("app: {{SDset_DS: {}}}", u8::from(demand)));
        demanded = demand;
        left = path.iter().any(|t| t == T(28)) || path.is_empty() && left;
        let expect = match path.is_empty() {
            true => idle(device, left),
            false => expected(&before, device, &path, absolute),
        };
        told.push(Told { before: set.into_iter().collect(), action, expect, path, error });
    }
    told
}

/// What is expected of an FS-Device that was left alone; `left`: the way that led here ended with T28 (A20: setSD_DC).
fn idle(device: &Device, left: bool) -> Vec<String> {
    let mut expect = vec!["image: unchanged".to_owned(), "app.PDout_D: unchanged".to_owned()];
    if !left && device.state() != State(21) {
        expect.push(format!("app.setSD_DC: {}", device.get(Var::SetSdDc)));
    }
    expect
}

/// What is expected of an FS-Device that has gone this way, `absolute`: its counter as a number. What a tolerance leaves free is not.
pub fn expected(before: &Device, device: &Device, path: &Path, absolute: bool) -> Vec<String> {
    let took = |numbers: &[u8]| path.iter().any(|t| numbers.contains(&t.0));
    let (expired, leaves) = (took(&[30, 31]), took(&[28]));
    let error = !expired && device.get(Var::CommErr) == 1;
    let status = device.status();
    let bit = u8::from;
    let dcount_i = match (absolute, expired) {
        (true, _) => status.dcount_i.to_string(),
        (false, true) => "unchanged".to_owned(),
        (false, false) => "mirror".to_owned(),
    };
    let mut expect = vec![format!("DCount_i: {dcount_i}")];
    // A11: SDset of an answer to setSD.
    if status.sd_set || error || device.get(Var::SetSdRx) == 0 {
        expect.push(format!("SDset: {}", bit(status.sd_set)));
    }
    // A33: an expiry leaves DCommErr alone, an error DTimeout.
    if !(expired && before.status().d_comm_err) {
        expect.push(format!("DCommErr: {}", bit(status.d_comm_err)));
    }
    if !(error && status.d_timeout) {
        expect.push(format!("DTimeout: {}", bit(status.d_timeout)));
    }
    expect.push(format!("app.PDout_D: {}", if device.uses_pdout() { "live" } else { "safe" }));
    // A20: setSD_DC with T28. A27: ChFAckReq_DC of an SPDU in error.
    if !leaves {
        expect.push(format!("app.setSD_DC: {}", bit(device.get(Var::SetSdDc) == 1)));
    }
    if !error && !expired {
        expect.push(format!("app.ChFAckReq_DC: {}", device.get(Var::ChFAckReqDc)));
    }
    expect
}

/// The tours.
pub fn tours() -> Vec<Vec<Told>> {
    super::tours::<Bench>().iter().map(|tour| steps(tour, false)).collect()
}
