//! DUTs of both roles that answer as they should until they turn: fsct says so in one line, blames the DUT and not the
//! product, keeps what it saw, and judges the other cases.

mod cli;

use assert_cmd::Command;
use cli::Folder;
use fsct_adapters::frame::{SYNC, encode};
use fsct_adapters::message::{self, ERROR, OBSERVED};
use fsct_adapters::{Description, Dut, DutError, Observation, Role, Stimulus, serve_stream};
use fsct_reference::{FsDevice, FsMaster, MasterOptions, Options};
use rstest::rstest;
use serde_json::Value;
use std::io::{self, Read, Write};
use std::net::{Shutdown, TcpListener, TcpStream};
use std::time::Duration;

/// Answers of the first connection before the DUT turns: some cases have ended then, and one is in its middle.
const HONEST: usize = 158;
/// More than a harness may take of a stream it has no use for; sockets hold some of it.
const MUCH: usize = 64 << 20;
/// Text no terminal and no page may get as it is.
const HOSTILE: &str = "<script>alert(1)</script> ]]> & \u{1b}[31m \u{7} \u{202e}gpj.exe\r\n\u{0}";

/// What becomes of the answer at which the DUT turns; the other is the answer before it.
type Turn = fn(&mut TcpStream, &[u8], &[u8]) -> io::Result<()>;

fn truncated(socket: &mut TcpStream, answer: &[u8], _: &[u8]) -> io::Result<()> {
    socket.write_all(&answer[..answer.len() - 1])?;
    socket.shutdown(Shutdown::Write)
}

fn oversized(socket: &mut TcpStream, answer: &[u8], _: &[u8]) -> io::Result<()> {
    socket.write_all(&encode(OBSERVED, answer[3], &[0; 0xFFFF]).unwrap_or_default())
}

fn bit_flipped(socket: &mut TcpStream, answer: &[u8], _: &[u8]) -> io::Result<()> {
    let mut flipped = answer.to_vec();
    flipped[answer.len() / 2] ^= 4;
    socket.write_all(&flipped)
}

fn replayed(socket: &mut TcpStream, _: &[u8], before: &[u8]) -> io::Result<()> {
    socket.write_all(before)
}

fn out_of_order(socket: &mut TcpStream, answer: &[u8], _: &[u8]) -> io::Result<()> {
    let next = encode(OBSERVED, answer[3].wrapping_add(1), &[0]).unwrap_or_default();
    socket.write_all(&[&next, answer].concat())
}

fn silent(_: &mut TcpStream, _: &[u8], _: &[u8]) -> io::Result<()> {
    Ok(())
}

/// One octet at a time of a frame too long to end in time; what is waited for between them is that fsct hangs up.
fn dripping(socket: &mut TcpStream, answer: &[u8], _: &[u8]) -> io::Result<()> {
    socket.set_read_timeout(Some(Duration::from_millis(20)))?;
    for octet in [SYNC[0], SYNC[1], OBSERVED, answer[3], 0xFF, 0xFF].into_iter().chain([0; 0xFFFF]) {
        socket.write_all(&[octet])?;
        if let Ok(0) = socket.read(&mut [0]) {
            break;
        }
    }
    Ok(())
}

/// A gigabyte of noise, or as much as is taken. Were it too much, nobody would answer in the next cases.
fn endless(socket: &mut TcpStream, _: &[u8], _: &[u8]) -> io::Result<()> {
    let mut taken = 0;
    while taken < 1 << 30 && socket.write_all(&[0x47; 1 << 16]).is_ok() {
        taken += 1 << 16;
    }
    assert!(taken < MUCH, "{taken} octets were taken");
    Err(io::ErrorKind::BrokenPipe.into())
}

fn complaining(socket: &mut TcpStream, answer: &[u8], _: &[u8]) -> io::Result<()> {
    socket.write_all(&encode(ERROR, answer[3], &message::pack_error(HOSTILE)).unwrap_or_default())
}

/// The DUT's end of a connection: passes answers on until it turns.
struct Turning {
    socket: TcpStream,
    honest: usize,
    turn: Turn,
    before: Vec<u8>,
}

impl Write for Turning {
    /// The server writes one answer at once.
    fn write(&mut self, answer: &[u8]) -> io::Result<usize> {
        match self.honest.checked_sub(1) {
            None => {
                // Nothing is sound from here on.
                self.honest = 0;
                (self.turn)(&mut self.socket, answer, &self.before)?;
                self.turn = silent;
            }
            Some(rest) => {
                self.honest = rest;
                self.socket.write_all(answer)?;
                self.before = answer.to_vec();
            }
        }
        Ok(answer.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

fn reference(role: Role) -> Box<dyn Dut> {
    match role {
        Role::Device => Box::new(FsDevice::new(Options::default())),
        Role::Master => Box::new(FsMaster::new(MasterOptions::default())),
    }
}

/// Serves a DUT for as long as the test lives. The first connection turns after so many answers, later ones do not; unless
/// the DUT can be reached `again`, there are none.
fn served(make: impl Fn() -> Box<dyn Dut> + Send + 'static, honest: usize, turn: Turn, again: bool) -> String {
    let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
    let address = listener.local_addr().expect("it is bound");
    std::thread::spawn(move || {
        let serve = |socket: TcpStream, honest: usize| {
            let _ = socket.set_nodelay(true);
            let reader = socket.try_clone().expect("a clone");
            let writer = Turning { socket, honest, turn, before: Vec::new() };
            // A harness that hangs up early is what this is about.
            let _ = serve_stream(reader, writer, make());
        };
        let (first, _) = listener.accept().expect("fsct connects");
        let listener = again.then_some(listener);
        serve(first, honest);
        listener.iter().flat_map(TcpListener::incoming).flatten().for_each(|socket| serve(socket, usize::MAX));
    });
    format!("tcp://{address}?timeout=1s")
}

/// A run, its exit code and what it said.
struct Ran {
    folder: Folder,
    code: Option<i32>,
    said: String,
}

impl Ran {
    fn new(name: &str, url: &str, filter: &str) -> Ran {
        let folder = Folder::new(name);
        let args = ["run", "--dut", url, "--filter", filter, "--out", &folder.out()];
        let output = Command::cargo_bin("fsct").expect("it is built").args(args).output().expect("it runs");
        let said = [output.stdout, output.stderr].map(|octets| String::from_utf8_lossy(&octets).into_owned());
        Ran { folder, code: output.status.code(), said: said.concat() }
    }

    fn summary(&self) -> Value {
        serde_json::from_str(&self.folder.text("summary.json")).expect("JSON")
    }

    /// The cases of the record, in order.
    fn cases(&self) -> Vec<Value> {
        let record = self.folder.text("run.jsonl");
        let lines = record.lines().map(|line| serde_json::from_str::<Value>(line).expect("JSON"));
        lines.filter_map(|line| line.get("case").cloned()).collect()
    }
}

const fn name(role: Role) -> (&'static str, &'static str) {
    match role {
        Role::Device => ("device", "FSD-000"),
        Role::Master => ("master", "FSM-020"),
    }
}

#[rstest]
#[case::truncated("truncated", truncated, "dut-error", "the DUT closed the connection")]
#[case::oversized("oversized", oversized, "dut-error", "octets that are no message")]
#[case::bit_flipped("bit-flipped", bit_flipped, "dut-error", "a frame had the CRC")]
#[case::replayed("replayed", replayed, "dut-error", "it answered sequence number")]
#[case::out_of_order("out-of-order", out_of_order, "dut-error", "it answered sequence number")]
#[case::silent("silent", silent, "timeout", "no complete answer within 1s")]
#[case::dripping("dripping", dripping, "timeout", "no complete answer within 1s")]
#[case::endless("endless", endless, "dut-error", "octets that are no frame, beginning \"GGGG")]
#[case::complaining("complaining", complaining, "dut-error", r#"it reported "<script>alert(1)</script>"#)]
fn one_case_is_lost_and_the_others_are_judged(
    #[values(Role::Device, Role::Master)] role: Role,
    #[case] way: &str,
    #[case] turn: Turn,
    #[case] execution: &str,
    #[case] says: &str,
) {
    let (role_name, filter) = name(role);
    let url = served(move || reference(role), HONEST, turn, true);
    let ran = Ran::new(&format!("{way}-{role_name}"), &url, filter);
    assert_eq!(ran.code, Some(3), "{}", ran.said);
    let summary = ran.summary();
    assert_eq!(summary["verdicts"]["fail"], 0, "{summary}");
    assert_eq!(summary["verdicts"]["inconclusive"], 1, "{summary}");
    assert_eq!(summary["execution"][execution], 1, "{summary}");

    let honest = Ran::new(&format!("{way}-{role_name}-honest"), &format!("inproc:reference-{role_name}"), filter);
    let (cases, sound) = (ran.cases(), honest.cases());
    assert_eq!(cases.len(), sound.len());
    let lost = cases.iter().position(|case| case["execution"] == execution).expect("one case");
    for (case, sound) in cases.iter().zip(&sound) {
        assert!(case["key"] == sound["key"] && (case["verdict"] == sound["verdict"] || case == &cases[lost]));
    }

    // One reason in one line, which the user is told.
    let reasons = cases[lost]["reasons"].as_array().expect("a list");
    let observed = reasons[0]["observed"].as_str().expect("a text");
    assert!(reasons.len() == 1 && observed.contains(says) && !observed.contains(char::is_control), "{observed}");
    assert_eq!(ran.said.matches(observed).count(), 1, "{}", ran.said);

    // What had crossed the boundary before is recorded as if nothing had come after it.
    let (kept, whole) = (&cases[lost]["trace"], &sound[lost]["trace"]);
    let (kept, whole) = (kept.as_array().expect("a list"), whole.as_array().expect("a list"));
    assert!(kept.len() > 5, "{} entries are kept", kept.len());
    // Of the last one less may have been seen.
    let all_but_last = kept.len() - 1;
    assert_eq!(kept[..all_but_last], whole[..all_but_last]);
}

#[rstest]
fn a_dut_that_is_gone_for_good_is_a_matter_of_the_rig(#[values(Role::Device, Role::Master)] role: Role) {
    let (role_name, filter) = name(role);
    let url = served(move || reference(role), HONEST, truncated, false);
    let ran = Ran::new(&format!("gone-{role_name}"), &url, filter);
    assert_eq!(ran.code, Some(3), "{}", ran.said);
    let summary = ran.summary();
    assert_eq!(summary["verdicts"]["fail"], 0, "{summary}");
    assert_eq!(summary["execution"]["dut-error"], 1, "{summary}");
    assert_eq!(summary["execution"]["rig-error"], 3, "{summary}");
    assert!(summary["verdicts"]["pass"].as_u64() > Some(0), "{summary}");
    assert!(summary["execution"]["aborted"].as_u64() > Some(0), "{summary}");
}

/// A reference whose maker means harm.
struct Named(Box<dyn Dut>);

impl Dut for Named {
    fn hello(&mut self) -> Result<Description, DutError> {
        let names = || HOSTILE.to_owned();
        Ok(Description { vendor: names(), product: names(), version: names(), ..self.0.hello()? })
    }

    fn apply(&mut self, stimuli: &[Stimulus], observed: &mut Vec<Observation>) -> Result<(), DutError> {
        self.0.apply(stimuli, observed)
    }
}

/// Nothing in what was said and written can do harm where it is shown.
fn is_harmless(ran: &Ran) {
    let texts = [ran.said.clone(), ran.folder.text("report.html"), ran.folder.text("junit.xml")];
    for text in &texts {
        for hostile in ["\u{1b}", "\u{7}", "\u{202e}", "\u{0}", "\r"] {
            assert!(!text.contains(hostile), "{hostile:?} is in {text}");
        }
    }
    for text in &texts[1..] {
        assert!(!text.contains("<script") && text.contains("&lt;script&gt;alert(1)"), "{text}");
    }
    assert!(!texts[2].contains("]]>"));
}

#[rstest]
fn the_names_a_dut_gives_itself_do_no_harm(#[values(Role::Device, Role::Master)] role: Role) {
    let (role_name, filter) = name(role);
    let url = served(move || Box::new(Named(reference(role))), usize::MAX, silent, true);
    let ran = Ran::new(&format!("names-{role_name}"), &url, filter);
    assert_eq!(ran.code, Some(0), "{}", ran.said);
    is_harmless(&ran);
}

#[rstest]
#[case::to_the_hello(0)]
#[case::to_a_request(HONEST)]
fn what_a_dut_complains_of_does_no_harm(#[case] honest: usize) {
    let url = served(|| reference(Role::Device), honest, complaining, true);
    let ran = Ran::new(&format!("complains-{honest}"), &url, name(Role::Device).1);
    assert_eq!(ran.code, Some(3), "{}", ran.said);
    assert!(ran.said.contains(r"it reported "), "{}", ran.said);
    is_harmless(&ran);
}
