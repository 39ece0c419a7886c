//! Each property sees what it is there for: exchanges that no machine of the tables has, made by hand.

use fsct_proof::{Around, Fate, Joint, Leg, Model, PROPERTIES, Seen, Step, Watched, World, image};
use fsct_protocol::Edition;
use fsct_protocol::scl::device::{Readings, Received};
use fsct_protocol::scl::master::Answer;
use fsct_protocol::scl::{Device, Master, Path, State, Var};
use fsct_protocol::spdu::{Control, Status};
use proptest::prelude::*;

const NOWHERE: Joint = Joint { master: 0, device: 0, mtimer: 0, dtimer: 0 };

fn watched(name: &str, monitor: u16, from: Joint, master: (Master, Path), device: (Device, Path)) -> Watched {
    let leg = |path| Leg { to: 0, timer: 0, path, fate: Fate::Delivered, pressed: false, demand: false };
    let step = Step { to: NOWHERE, device: leg(device.1), master: leg(master.1) };
    let model = Model::new(Edition::Iec2022);
    let seen =
        Seen { model: &model, from, started: true, step: &step, master: master.0.into(), device: device.0.into() };
    let property = PROPERTIES.iter().find(|property| property.name == name).expect("a property");
    property.watch.expect("a property that watches")(&seen, monitor)
}

fn waiting_master() -> (Master, Path) {
    let mut master = Master::new();
    master.start();
    (master, Path::default())
}

/// In regular operation, process data in use, behind T6, T4, T5.
fn live_master() -> (Master, Path) {
    let mut master = Master::regular(3);
    let path = master.receive(Answer { status: Status { dcount_i: 4, ..Status::default() }, intact: true });
    (master, path)
}

/// In regular operation, process data in use, behind T24, T22, T23.
fn live_device() -> (Device, Path) {
    let mut device = Device::regular(3);
    let path = device.receive(Received { control: Control { mcount: 4, ..Control::default() }, intact: true });
    (device, path)
}

fn tripped_device() -> (Device, Path) {
    let mut device = Device::regular(3);
    let path = device.receive(Received { control: Control { mcount: 4, ..Control::default() }, intact: false });
    (device, path)
}

#[test]
fn an_early_restart_is_seen() {
    assert_eq!(watched("P2", 1, NOWHERE, live_master(), live_device()).measure, 1);
    assert_eq!(watched("P2", 0, NOWHERE, live_master(), live_device()).measure, 0);
    assert_eq!(watched("P2d", 1, NOWHERE, live_master(), live_device()).measure, 1);
    assert_eq!(watched("P2d", 0, NOWHERE, live_master(), tripped_device()).monitor, 1);
}

/// Behind a fault, a good answer with ChFAck_C at this level, and another at 1.
fn acknowledging_master(pressed: bool) -> [(Master, Path); 2] {
    let good = |dcount_i| Answer { status: Status { dcount_i, ..Status::default() }, intact: true };
    let mut master = Master::after_fault(0);
    master.set_ch_f_ack_c(pressed);
    let first = master.receive(good(7));
    let requesting = master;
    master.set_ch_f_ack_c(true);
    let second = master.receive(good(6));
    [(requesting, first), (master, second)]
}

#[test]
fn an_acknowledgment_is_0_and_then_1() {
    let safe = || (tripped_device().0, Path::default());
    for name in ["P2", "P2d"] {
        let [released, acknowledged] = acknowledging_master(false);
        assert_eq!(watched(name, 1, NOWHERE, released, safe()).monitor, 2, "{name}");
        assert_eq!(watched(name, 2, NOWHERE, acknowledged, safe()).monitor, 0, "{name}");
        assert_eq!(watched(name, 1, NOWHERE, acknowledged, safe()).monitor, 1, "{name}");
        let [held, still] = acknowledging_master(true);
        assert_eq!(watched(name, 1, NOWHERE, held, safe()).monitor, 1, "{name}");
        assert_eq!(watched(name, 1, NOWHERE, still, safe()).monitor, 1, "{name}");
    }
}

#[test]
fn sd_cycles_left_out_are_seen() {
    assert_eq!(watched("P3", 0, NOWHERE, live_master(), live_device()).measure, 3);
    assert_eq!(watched("P3", 3, NOWHERE, live_master(), live_device()).measure, 0);
    assert_eq!(watched("P3", 3, NOWHERE, live_master(), tripped_device()).monitor, 0);
    let mut device = Device::new(Readings::default());
    device.start();
    let path = device.receive(Received { control: Control::default(), intact: true });
    assert_eq!(watched("P3", 0, NOWHERE, waiting_master(), (device, path)).monitor, 1);
    // An answer that stands counts once.
    assert_eq!(watched("P3", 1, NOWHERE, waiting_master(), (device, Path::default())).monitor, 1);
}

#[test]
fn a_reaction_that_does_not_come_is_seen() {
    let first = watched("P4", 0, NOWHERE, live_master(), tripped_device());
    let second = watched("P4", first.monitor, NOWHERE, live_master(), (tripped_device().0, Path::default()));
    assert_eq!((first.measure, second.measure), (1, 2));
    assert_eq!(watched("P4", second.monitor, NOWHERE, waiting_master(), tripped_device()).monitor, 0);
    let mut timed_out = Master::regular(3);
    let path = timed_out.expire();
    let first = watched("P4", 0, NOWHERE, (timed_out, path), live_device());
    let second = watched("P4", first.monitor, NOWHERE, waiting_master(), live_device());
    assert_eq!((first.measure, second.measure), (1, 2));
}

#[test]
fn old_data_is_seen() {
    let from = Joint { mtimer: 6, dtimer: 9, ..NOWHERE };
    assert_eq!(watched("P1-taken", 0, from, live_master(), live_device()).measure, 10);
    assert_eq!(watched("P1-live", 0, from, waiting_master(), live_device()).measure, 7);
    let unchanged = (live_device().0, Path::default());
    assert_eq!(watched("P1-live", 7, from, waiting_master(), unchanged).measure, 8);
}

#[test]
fn an_answer_from_before_is_seen() {
    let (before, after) = (Joint { mtimer: 1, dtimer: 1, ..NOWHERE }, Joint { mtimer: 1, dtimer: 0, ..NOWHERE });
    for name in ["P7-live", "P7-good"] {
        assert_eq!(watched(name, 0, before, live_master(), live_device()).measure, 1, "{name}");
        assert_eq!(watched(name, 0, after, live_master(), live_device()).measure, 0, "{name}");
    }
}

#[test]
fn a_report_too_often_or_withheld_is_seen() {
    let (device, path) = tripped_device();
    assert!(device.status().d_comm_err && !path.is_empty());
    assert_eq!(watched("P6-comm", 0, NOWHERE, live_master(), (device, path)).measure, 1);
    // A good answer that still shows the bit: the third is one too many.
    let mut again = device;
    let good = again.receive(Received { control: Control { mcount: 5, ..Control::default() }, intact: true });
    assert_eq!(watched("P6-comm", 2, NOWHERE, live_master(), (again, good)).measure, 3);
    assert_eq!(watched("P6-further", 1, NOWHERE, live_master(), (again, good)).measure, 0);
    assert_eq!(watched("P6-further", 1, NOWHERE, live_master(), live_device()).measure, 1);
    assert_eq!(watched("P6-timeout", 0, NOWHERE, live_master(), live_device()).measure, 0);
}

#[test]
fn a_demand_that_does_nothing_is_seen() {
    assert_eq!(watched("P8", 0, NOWHERE, live_master(), live_device()).fork, Some(1));
    assert_eq!(watched("P8", 7, NOWHERE, live_master(), live_device()).measure, 7);
    assert_eq!(watched("P8", 7, NOWHERE, live_master(), tripped_device()).measure, 0);
}

fn rows(device: &fsct_proof::Device) -> Device {
    match device {
        fsct_proof::Device::Rows(device) => *device,
        fsct_proof::Device::Learned(_) => panic!("nothing was learnt"),
    }
}

proptest! {
    /// What a walk through the composition shows is what the two machines show when the same images reach them one by one.
    #[test]
    fn the_composition_is_the_two_machines(choices in prop::collection::vec(any::<prop::sample::Index>(), 1..60)) {
        let mut world = World::new(&Model::new(Edition::Iec2022));
        let mut at = world.start();
        let mut master = Master::new();
        master.start();
        let mut device = rows(&world.device(at.device));
        for choice in choices {
            let steps = world.steps(at, Around::Free);
            let step = choice.get(&steps);
            let (control, status) = (master.control(), image(&device.into()));
            let expired = |path: &Path, numbers: [u8; 2]| path.iter().any(|t| numbers.contains(&t.0));
            let after = world.device(step.to.device);
            device.set_sdset_ds(step.device.pressed);
            let path = match step.device.fate {
                _ if after.state() == State(20) => { device = rows(&after); Path::default() }
                _ if device.state() == State(20) => device.start(),
                _ if expired(&step.device.path, [30, 31]) => device.expire(),
                Fate::Delivered => device.receive(Received { control, intact: true }),
                Fate::Bad(mcount) => device.receive(Received { control: Control { mcount, ..control }, intact: false }),
                Fate::Lost | Fate::Stored(_) => Path::default(),
            };
            prop_assert_eq!(path, step.device.path);
            prop_assert_eq!((device.state(), image(&device.into()), device.uses_pdout()), (after.state(), image(&after), after.uses_pdout()));
            master.set_ch_f_ack_c(step.master.pressed);
            master.set_set_sd_c(step.master.demand);
            let path = match (step.master.fate, status) {
                _ if expired(&step.master.path, [8, 14]) => master.expire(),
                (Fate::Delivered, Some(status)) => master.receive(Answer { status, intact: true }),
                (Fate::Bad(dcount_i), _) => master.receive(Answer { status: Status { dcount_i, ..Status::default() }, intact: false }),
                _ => Path::default(),
            };
            let after = world.master(step.to.master);
            prop_assert_eq!(path, step.master.path);
            prop_assert_eq!((master.state(), master.control(), master.get(Var::In)), (after.state(), after.control(), after.get(Var::In)));
            at = step.to;
        }
    }
}
