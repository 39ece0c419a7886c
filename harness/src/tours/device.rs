//! What a scripted FS-Master does to an FS-Device on a tour, and what the answer has to be.

use super::Subject;
use super::emit::{Told, wait};
use fsct_adapters::Role;
use fsct_protocol::scl::device::{Readings, Received};
use fsct_protocol::scl::{Device, Path, Var};
use fsct_protocol::spdu::{Control, succ};

/// An SPDU, or none for too long.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Stimulus {
    /// The next counter.
    Next { set_sd: bool, ch_f_ack_req: bool },
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
    /// Nothing but this until DTimer has expired.
    Timeout(&'static str),
}

use Stimulus::{Corrupt, Foreign, Jump, Next, Same, Timeout, Zero};

/// The machine.
#[derive(Copy, Clone, PartialEq, Eq, Hash)]
pub struct Bench(Device);

impl Subject for Bench {
    type Stimulus = Stimulus;

    const ROLE: Role = Role::Device;
    const ALPHABET: &'static [Stimulus] = &[
        Next { set_sd: false, ch_f_ack_req: false },
        Corrupt("signature"),
        Timeout("lost"),
        Jump,
        Next { set_sd: true, ch_f_ack_req: false },
        Foreign,
        Timeout("zero"),
        Next { set_sd: false, ch_f_ack_req: true },
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
        let path = match stimulus {
            Next { set_sd, ch_f_ack_req } => device.receive(good(Control { mcount: next, set_sd, ch_f_ack_req })),
            Zero => device.receive(good(Control { mcount: 0, set_sd: true, ch_f_ack_req: false })),
            Same => device.previous().map_or_else(Default::default, |mcount| device.receive(good(control(mcount)))),
            Corrupt(_) | Foreign => device.receive(Received { control: control(next), intact: false }),
            Jump => device.receive(good(control(succ(succ(next))))),
            Timeout(_) => device.expire(),
        };
        (path, !matches!(stimulus, Timeout(_)) && device.get(Var::CommErr) == 1)
    }
}

/// A tour as steps of a case.
fn steps(tour: &[Stimulus]) -> Vec<Told> {
    let (mut bench, _) = Bench::waiting();
    let mut expiries = 0;
    let mut told = Vec::new();
    for stimulus in tour {
        let before = bench.0;
        let (path, error) = bench.apply(*stimulus);
        let device = &bench.0;
        let expired = matches!(stimulus, Timeout(_));
        expiries = if expired { expiries + 1 } else { 0 };
        let action = match stimulus {
            Next { set_sd: false, ch_f_ack_req: false } => "exchange: {}".to_owned(),
            Next { set_sd: true, .. } => "exchange: {setSD: 1}".to_owned(),
            Next { .. } => "exchange: {ChFAckReq: 1}".to_owned(),
            Zero => "exchange: {MCount: 0, setSD: 1, PDout: safe}".to_owned(),
            Same => "exchange: {MCount: same, PDout: same, repeat: 2}".to_owned(),
            Corrupt(field) => format!("exchange: {{corrupt: {field}}}"),
            Foreign => "exchange: {PortNum: foreign}".to_owned(),
            Jump => "exchange: {MCount: +2}".to_owned(),
            Timeout(link) => wait(expiries, link),
        };
        let expect = expected(&before, device, &path);
        told.push(Told { before: Vec::new(), action, expect, path, error });
    }
    told
}

/// What is expected of an FS-Device that has gone this way. What a tolerance leaves free is not.
pub fn expected(before: &Device, device: &Device, path: &Path) -> Vec<String> {
    let took = |numbers: &[u8]| path.iter().any(|t| numbers.contains(&t.0));
    let (expired, leaves) = (took(&[30, 31]), took(&[28]));
    let error = !expired && device.get(Var::CommErr) == 1;
    let status = device.status();
    let bit = u8::from;
    let mut expect = vec![format!("DCount_i: {}", if expired { "unchanged" } else { "mirror" })];
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
    super::tours::<Bench>().iter().map(|tour| steps(tour)).collect()
}
