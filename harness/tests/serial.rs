//! The command over a serial line: `fsct simulate --listen pty` at one end, `fsct run --dut serial:..` at the other.
#![cfg(unix)]

mod cli;

use cli::Folder;
use fsct_adapters::serve_stream;
use fsct_reference::{FsDevice, Options};
use rstest::rstest;
use rustix::fs::{Mode, OFlags, open};
use rustix::pty::{OpenptFlags, openpt, ptsname, unlockpt};
use serde_json::Value;
use serialport::{SerialPort as _, TTYPort};
use std::fs::File;
use std::io::{BufRead, BufReader, Read};
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

/// Round trips on a line vary more than a cycle takes; nothing of it is held against the DUT.
#[rstest]
fn a_campaign_finds_nothing_on_a_line_with_a_real_clock(#[values("device", "master")] role: &str) {
    let reference = Simulated::new(&[role, "--clock", "real"]);
    let folder = Folder::new(&format!("serial-campaign-{role}"));
    for what in [["random", "--exchanges", "300", "--faults", "60"], ["bits", "--flips", "1", "--length", "4"]] {
        let args = [&["campaign"], &what[..], &["--mode", "crc16", "--dut", &reference.url, "--out", &folder.out()]];
        let run = fsct(&args.concat()).output().expect("it runs");
        assert_eq!(run.status.code(), Some(0), "{run:?}");
    }
}

/// The line serves one at a time: the campaign gives it up before it repeats what failed.
#[test]
fn what_a_campaign_finds_on_a_line_is_repeated_and_shrunk() {
    let mutant = Simulated::new(&["device", "--mutant", "d-comm-err-never-reported"]);
    let folder = Folder::new("serial-campaign-mutant");
    let common = ["--mode", "crc16", "--dut", &mutant.url, "--out", &folder.out()];
    for what in [["random", "--exchanges", "3000", "--faults", "300"], ["bits", "--flips", "1", "--length", "4"]] {
        let run = fsct(&[&["campaign"], &what[..], &common].concat()).output().expect("it runs");
        assert_eq!(run.status.code(), Some(1), "{run:?}");
        let told = String::from_utf8_lossy(&run.stdout);
        assert!(told.contains("  replay   fsct campaign replay "), "{told}");
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
    // More where the loop-back, on a machine that has other work, shows less than the DUT states.
    assert!(number(&dut["uncertainty_ns"]) >= OWN_UNCERTAINTY_NS + (max - min) / 2);
}

/// The same Ready pulse of 550 us, 50 us inside its limit: time stamps behind a line do not tell, a recording does.
#[test]
fn what_a_line_leaves_open_a_precise_recording_decides() {
    let folder = Folder::new("serial-and-capture");
    let out = folder.out();
    let pulse = ["device", "--pulse-us", "550"];
    let behind_a_line = Simulated::new(&[&pulse[..], &["--clock", "real"]].concat());
    let profile = ["--profile", "device-real-time", "--filter", "FSD-1701", "--edition", "iec2022"];
    let live = [&["run", "--dut", &behind_a_line.url, "--out", &out][..], &profile].concat();
    let live = fsct(&live).output().expect("it runs");
    assert_eq!(live.status.code(), Some(5), "{live:?}");
    assert!(String::from_utf8_lossy(&live.stderr).contains("measure/t_RP"), "{live:?}");

    let vcd = folder.0.join("lines.vcd").display().to_string();
    let binary = assert_cmd::cargo::cargo_bin("fsct");
    let url = format!("exec:{} simulate {} --listen stdio --vcd {vcd}", binary.display(), pulse.join(" "));
    fsct(&["run", "device-lines", "--filter", "FSD-1701", "--dut", &url, "--out", &out]).output().expect("it runs");
    let recorded = ["capture", &vcd, "--profile", "device-real-time", "--edition", "iec2022", "--out", &out];
    let recorded = fsct(&recorded).output().expect("it runs");
    let case = folder.lines().into_iter().find(|line| line["case"]["id"] == "FSD-1701").expect("it was judged");
    assert_eq!(case["case"]["verdict"], "pass", "{recorded:?}");
}

/// Octets a board has received when its cable is pulled: some cases have ended then, and one is in its middle.
const PULLED: usize = 100_000;

/// A reader that comes to its end after so many octets.
struct Cut<R>(R, usize);

impl<R: Read> Read for Cut<R> {
    fn read(&mut self, octets: &mut [u8]) -> std::io::Result<usize> {
        let most = self.1.min(octets.len());
        let count = if most == 0 { 0 } else { self.0.read(&mut octets[..most])? };
        self.1 -= count;
        Ok(count)
    }
}

/// A board behind a name that stays while what is behind it goes and comes, as udev gives one. It is pulled after each
/// of these many octets but the last, and plugged in again.
fn plugged(folder: &Folder, plugs: &'static [usize]) -> String {
    let (name, fresh) = (folder.0.join("board"), folder.0.join("fresh"));
    let url = format!("serial:{}", name.display());
    let (ready, plugged) = std::sync::mpsc::channel();
    thread::spawn(move || {
        for octets in plugs {
            // Not to be handed on to a child, or the line would hang on it.
            let board = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY | OpenptFlags::CLOEXEC).expect("a terminal");
            unlockpt(&board).expect("it is ours");
            let path = ptsname(&board, Vec::new()).expect("it has a name").into_string().expect("in ASCII");
            // Open at both ends for as long as it is plugged.
            let _cable = open(&path, OFlags::RDWR | OFlags::NOCTTY | OFlags::CLOEXEC, Mode::empty()).expect("its end");
            let board = File::from(board);
            let writer = board.try_clone().expect("a clone");
            std::os::unix::fs::symlink(&path, &fresh).expect("a link can be made");
            std::fs::rename(&fresh, &name).expect("and put in place");
            let _ = ready.send(());
            let _ = serve_stream(Cut(board, *octets), writer, Box::new(FsDevice::new(Options::default())));
        }
        let _ = std::fs::remove_file(&name);
    });
    plugged.recv().expect("it is plugged in once");
    url
}

#[test]
fn a_line_pulled_in_the_middle_leaves_what_was_judged_before() {
    let folder = Folder::new("serial-pulled");
    let url = format!("{}?wait=1ms", plugged(&folder, &[PULLED]));
    let run = fsct(&["run", "--dut", &url, "--out", &folder.out()]).output().expect("it runs");
    assert_eq!(run.status.code(), Some(3), "{run:?}");
    let counts = folder.counts();
    assert!(counts["ok pass"] > 1 && counts["aborted inconclusive"] > 1, "{counts:?}");
    // The case in which the line went, and three that were not begun.
    assert_eq!(counts["rig-error inconclusive"], 4, "{counts:?}");
    assert_eq!(counts.len(), 3, "{counts:?}");
}

#[test]
fn a_line_pulled_and_plugged_again_costs_one_case() {
    let folder = Folder::new("serial-again");
    let url = format!("{}?wait=60s", plugged(&folder, &[PULLED, usize::MAX]));
    let run = fsct(&["run", "--dut", &url, "--out", &folder.out()]).output().expect("it runs");
    assert_eq!(run.status.code(), Some(3), "{run:?}");
    let others = folder.planned() - 1;
    assert_eq!(folder.counts(), [("ok pass".to_owned(), others), ("rig-error inconclusive".to_owned(), 1)].into());
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
#[case::device("device", fsct_c::DEVICE, "reference-device")]
#[case::master("master", fsct_c::MASTER, "master-without-storage")]
fn a_stack_in_c_at_the_other_end_of_a_line(#[case] role: &str, #[case] sources: &[&str], #[case] profile: &str) {
    let sources = [fsct_c::CLIENT, sources].concat();
    let Some(program) = fsct_c::build(fsct_c::Kind::Program, &sources, &["-DFSCT_CLIENT_PAYLOAD=2048"]) else { return };
    let [(_board, board), (_port, port)] = null_modem();
    let mut child = Command::new(program).arg(board).spawn().expect("it starts");
    let folder = Folder::new(&format!("serial-c-{role}"));
    let url = format!("serial:{port}");
    let run = fsct(&["run", "--dut", &url, "--profile", profile, "--out", &folder.out()]).output().expect("it runs");
    let _ = child.kill();
    let _ = child.wait();
    assert_eq!(run.status.code(), Some(0), "{run:?}");
    assert_eq!(folder.counts(), [("ok pass".to_owned(), folder.planned())].into());
}
