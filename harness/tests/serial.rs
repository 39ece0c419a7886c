//! The command over a serial line: `fsct simulate --listen pty` at one end, `fsct run --dut serial:..` at the other.
#![cfg(unix)]

mod cli;

use cli::Folder;
use rstest::rstest;
use serde_json::Value;
use serialport::{SerialPort as _, TTYPort};
use std::io::{BufRead, BufReader};
use std::process::{Child, Command, Stdio};
use std::thread;
use std::time::Duration;

/// What the reference states of its time stamps when its clock is real.
const OWN_UNCERTAINTY_NS: u64 = 100_000;

fn fsct(args: &[&str]) -> Command {
    let mut command = Command::new(assert_cmd::cargo::cargo_bin("fsct"));
    command.args(args).stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    command
}

/// A reference on a pseudo-terminal, gone when the test ends.
struct Simulated {
    child: Child,
    url: String,
}

impl Simulated {
    fn new(args: &[&str]) -> Simulated {
        let mut child = fsct(&[&["simulate"], args, &["--listen", "pty"]].concat()).spawn().expect("it starts");
        let mut said = String::new();
        let stderr = child.stderr.take().expect("it is piped");
        BufReader::new(stderr).read_line(&mut said).expect("it says where it is");
        let url = said.trim().rsplit(' ').next().expect("a word").to_owned();
        assert!(url.starts_with("serial:/"), "{said}");
        Simulated { child, url }
    }

    fn end(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

impl Drop for Simulated {
    fn drop(&mut self) {
        self.end();
    }
}

#[rstest]
#[case::device("device", "FSD-08*", "0")]
#[case::master("master", "FSM-02*", "0")]
fn a_reference_on_a_line_passes_run_after_run(#[case] role: &str, #[case] filter: &str, #[case] uncertainty: &str) {
    let reference = Simulated::new(&[role]);
    let folder = Folder::new(&format!("serial-{role}"));
    for _ in 0..2 {
        let args = ["run", "--dut", &reference.url, "--filter", filter, "--out", &folder.out()];
        let run = fsct(&args).output().expect("it runs");
        assert_eq!(run.status.code(), Some(0), "{run:?}");
        assert_eq!(folder.counts().keys().collect::<Vec<_>>(), ["ok pass"]);
        let header = folder.lines().swap_remove(0);
        let dut = &header["header"]["dut"][0];
        let trip = |key: &str| dut["round_trip"][key].as_u64().expect("a number");
        assert!(trip("min_ns") > 0 && trip("min_ns") <= trip("median_ns") && trip("median_ns") <= trip("max_ns"));
        // A virtual clock is as certain behind a line as anywhere.
        assert_eq!(dut["uncertainty_ns"].to_string(), uncertainty);
    }
}

#[test]
fn what_varies_on_the_way_to_a_real_clock_is_uncertain() {
    let reference = Simulated::new(&["device", "--clock", "real"]);
    let folder = Folder::new("serial-real");
    let args = ["run", "--dut", &reference.url, "--filter", "FSD-0001", "--out", &folder.out()];
    fsct(&args).output().expect("it runs");
    let header = folder.lines().swap_remove(0);
    let dut = &header["header"]["dut"][0];
    let number = |value: &Value| value.as_u64().expect("a number");
    let (min, max) = (number(&dut["round_trip"]["min_ns"]), number(&dut["round_trip"]["max_ns"]));
    assert_eq!(number(&dut["uncertainty_ns"]), OWN_UNCERTAINTY_NS + (max - min) / 2);
}

#[test]
fn a_line_pulled_in_the_middle_leaves_what_was_judged_before() {
    let mut reference = Simulated::new(&["device"]);
    let folder = Folder::new("serial-pulled");
    let url = format!("{}?wait=1ms", reference.url);
    let running = fsct(&["run", "--dut", &url, "--out", &folder.out()]).spawn().expect("it starts");
    while folder.lines().len() < 20 {
        thread::sleep(Duration::from_millis(1));
    }
    reference.end();
    let run = running.wait_with_output().expect("it ends by itself");
    assert_eq!(run.status.code(), Some(3), "{run:?}");
    let counts = folder.counts();
    assert!(counts["ok pass"] >= 19 && counts["aborted inconclusive"] > 0, "{counts:?}");
    // The case in which the line went, perhaps, and three that were not begun.
    let lost: usize = counts.iter().filter(|(key, _)| key.starts_with("rig-error ")).map(|(_, count)| count).sum();
    assert!((3..=4).contains(&lost), "{counts:?}");
    assert!(counts.keys().all(|key| !key.starts_with("dut-error") && !key.ends_with("fail")), "{counts:?}");
}

#[test]
fn a_line_pulled_and_plugged_again_costs_one_case() {
    let mut reference = Simulated::new(&["device"]);
    let folder = Folder::new("serial-again");
    // A name that stays while what is behind it goes and comes, as udev gives one.
    let name = folder.0.join("board");
    let plug = |reference: &Simulated| {
        let target = reference.url.strip_prefix("serial:").expect("a path");
        let fresh = folder.0.join("fresh");
        std::os::unix::fs::symlink(target, &fresh).expect("a link can be made");
        std::fs::rename(&fresh, &name).expect("and put in place");
    };
    plug(&reference);
    let url = format!("serial:{}?wait=60s", name.display());
    let running = fsct(&["run", "--dut", &url, "--out", &folder.out()]).spawn().expect("it starts");
    while folder.lines().len() < 20 {
        thread::sleep(Duration::from_millis(1));
    }
    reference.end();
    let again = Simulated::new(&["device"]);
    plug(&again);
    let run = running.wait_with_output().expect("it ends by itself");
    assert_eq!(run.status.code(), Some(3), "{run:?}");
    let counts = folder.counts();
    let lost: usize = counts.iter().filter(|(key, _)| key.starts_with("rig-error ")).map(|(_, count)| count).sum();
    assert_eq!((lost, counts["ok pass"]), (1, 1667), "{counts:?}");
}

/// Two lines, each with its far end at the other: their near ends.
fn null_modem() -> [(TTYPort, String); 2] {
    let [one, other] = [(), ()].map(|()| TTYPort::pair().expect("there are pseudo-terminals"));
    let end = |port: &TTYPort| port.try_clone_native().expect("a clone");
    for (mut from, mut to) in [(end(&one.0), end(&other.0)), (end(&other.0), end(&one.0))] {
        from.set_timeout(Duration::from_secs(3600)).expect("any time-out will do");
        thread::spawn(move || std::io::copy(&mut from, &mut to));
    }
    [one, other].map(|(far, near)| {
        let path = near.name().expect("a pseudo-terminal has a name");
        // Open for as long as the test lives, else a line ends when the first who opened it closes it.
        std::mem::forget(far);
        (near, path)
    })
}

#[rstest]
#[case::device("device", fsct_c::DEVICE, 1668)]
#[case::master("master", fsct_c::MASTER, 1434)]
fn a_stack_in_c_at_the_other_end_of_a_line(#[case] role: &str, #[case] sources: &[&str], #[case] cases: usize) {
    let sources = [fsct_c::CLIENT, sources].concat();
    let Some(program) = fsct_c::build(fsct_c::Kind::Program, &sources, &["-DFSCT_CLIENT_PAYLOAD=2048"]) else { return };
    let [(_board, board), (_port, port)] = null_modem();
    let mut child = Command::new(program).arg(board).spawn().expect("it starts");
    let folder = Folder::new(&format!("serial-c-{role}"));
    let run = fsct(&["run", "--dut", &format!("serial:{port}"), "--out", &folder.out()]).output().expect("it runs");
    let _ = child.kill();
    let _ = child.wait();
    assert_eq!(run.status.code(), Some(0), "{run:?}");
    assert_eq!(folder.counts(), [("ok pass".to_owned(), cases)].into());
}
