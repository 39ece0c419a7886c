//! DUTs that close, hang, flood and babble, over real sockets: each gets the right error, in time, and keeps it.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod common;

use common::*;
use fsct_adapters::frame::{Decoder, Frame, MAX_GARBAGE, encode};
use fsct_adapters::message::*;
use fsct_adapters::{
    Dut, DutError, FLOOD_PER_STIMULUS, FLOOD_SLACK, Fault, Line, Mode, Observation, Octets, Offer, Response, Role,
    Seen, Service, SmiService, Source, Stimulus, connect_within,
};
use rstest::rstest;
use std::io::{Read, Write};
use std::net::{Shutdown, TcpListener, TcpStream};
use std::time::Duration;

/// The DUT's side of a connection, written by hand.
struct Peer {
    socket: TcpStream,
    decoder: Decoder,
}

impl Peer {
    fn next(&mut self) -> Option<Frame> {
        let mut buffer = [0; 4096];
        loop {
            if let Some(frame) = self.decoder.next_frame() {
                return Some(frame);
            }
            let count = self.socket.read(&mut buffer).ok().filter(|count| *count > 0)?;
            self.decoder.push(&buffer[..count]);
        }
    }

    /// Until the harness has given up, nothing more is said.
    fn hang(&mut self) {
        while self.next().is_some() {}
    }

    fn raw(&mut self, octets: &[u8]) {
        // A harness that has seen enough does not wait for the rest.
        let _ = self.socket.write_all(octets);
    }

    fn send(&mut self, kind: u8, sequence: u8, payload: &[u8]) {
        self.raw(&encode(kind, sequence, payload).unwrap());
    }

    fn describe(&mut self) {
        let hello = self.next().unwrap();
        self.send(DESCRIPTION, hello.sequence, &pack_description(&description(), Limits::LEAST));
    }

    fn observed(&mut self, sequence: u8, observations: &[Observation]) {
        let mut payload = Vec::new();
        assert_eq!(pack_observed(observations, 0xFFFF, &mut payload), observations.len());
        self.send(OBSERVED, sequence, &payload);
    }
}

/// What the harness says to a DUT that treats the greeting like this; it says it a second time without asking.
fn greeted(act: impl FnOnce(&mut Peer) + Send + 'static) -> DutError {
    greeted_within(PATIENT, act)
}

fn greeted_within(timeout: Duration, act: impl FnOnce(&mut Peer) + Send + 'static) -> DutError {
    let address = peer(|socket| act(&mut Peer { socket, decoder: Decoder::new() }));
    let mut dut = connect_within(&address, timeout).unwrap();
    let error = dut.hello().unwrap_err();
    assert_eq!(error.fault(), Fault::Dut);
    assert_eq!(dut.apply(&[Stimulus::Power(true)], &mut Vec::new()), Err(error.clone()));
    error
}

/// What the harness says to a DUT that describes itself and then treats these stimuli like this.
fn applied(
    stimuli: &[Stimulus],
    act: impl FnOnce(&mut Peer, u8) + Send + 'static,
) -> (Result<(), DutError>, Vec<Observation>) {
    let address = peer(|socket| {
        let mut peer = Peer { socket, decoder: Decoder::new() };
        peer.describe();
        let sequence = peer.next().unwrap().sequence;
        act(&mut peer, sequence);
        peer.hang();
    });
    let mut dut = connect_within(&address, PATIENT).unwrap();
    assert_eq!(dut.hello(), Ok(description()));
    let mut observed = Vec::new();
    (dut.apply(stimuli, &mut observed), observed)
}

fn contract(what: &str) -> DutError {
    DutError::Contract { what: what.to_owned() }
}

fn garbage(what: &str) -> DutError {
    DutError::Garbage { what: what.to_owned() }
}

#[test]
fn it_closes() {
    assert_eq!(greeted(|_| {}), DutError::Closed { how: String::new() });
    let after_hello = |peer: &mut Peer| drop(peer.next());
    assert_eq!(greeted(after_hello), DutError::Closed { how: String::new() });
}

#[test]
fn it_closes_in_the_middle_of_a_frame() {
    let closed = greeted(|peer| {
        let sequence = peer.next().unwrap().sequence;
        peer.raw(&encode(DESCRIPTION, sequence, &[1; 9]).unwrap()[..12]);
    });
    assert_eq!(closed, DutError::Closed { how: String::new() });
}

#[test]
fn it_hangs() {
    assert_eq!(greeted_within(SHORT, Peer::hang), DutError::Timeout { after: SHORT });
}

#[test]
fn it_announces_more_than_it_sends() {
    let hanging = greeted_within(SHORT, |peer| {
        let sequence = peer.next().unwrap().sequence;
        peer.raw(&encode(DESCRIPTION, sequence, &[1; 900]).unwrap()[..200]);
        peer.hang();
    });
    assert_eq!(hanging, DutError::Timeout { after: SHORT });
}

#[test]
fn it_neither_reads_nor_writes() {
    let (let_go, wait) = std::sync::mpsc::channel::<()>();
    let address = peer(move |socket| {
        let mut peer = Peer { socket, decoder: Decoder::new() };
        let hello = peer.next().unwrap();
        let limits = Limits { payload: 0xFFFF, requests: 255 };
        peer.send(DESCRIPTION, hello.sequence, &pack_description(&description(), limits));
        // More requests than a socket holds follow, and nobody reads them.
        let _ = wait.recv();
    });
    let mut dut = connect_within(&address, SHORT).unwrap();
    dut.hello().unwrap();
    let stimuli = vec![Stimulus::Write { index: 0, subindex: 0, data: vec![0; 60_000] }; 300];
    assert_eq!(dut.apply(&stimuli, &mut Vec::new()), Err(DutError::Timeout { after: SHORT }));
    drop(dut);
    drop(let_go);
}

#[test]
fn it_babbles_without_end() {
    let error = greeted(|peer| while peer.socket.write_all(&[b'y'; 1000]).is_ok() {});
    let DutError::Garbage { what } = error else { panic!("{error:?}") };
    assert!(what.ends_with("octets that are no frame, beginning \"yyyyyyyyyyyyyyyy\""), "{what}");
}

#[test]
fn it_babbles_and_hangs() {
    let error = greeted_within(SHORT, |peer| {
        peer.raw(b"login: ");
        peer.hang();
    });
    assert_eq!(error, garbage("7 octets that are no frame, beginning \"login: \", then nothing within 250ms"));
}

#[test]
fn it_babbles_and_closes() {
    let error = greeted(|peer| {
        let _ = peer.next();
        peer.raw(b"\x1b[2Jno\n");
        peer.socket.shutdown(Shutdown::Write).unwrap();
        peer.hang();
    });
    let what = "7 octets that are no frame, beginning \"\\x1b[2Jno\\n\", then the end of the connection";
    assert_eq!(error, garbage(what));
}

#[test]
fn it_computes_another_checksum() {
    let error = greeted_within(SHORT, |peer| {
        let sequence = peer.next().unwrap().sequence;
        let mut octets = encode(DESCRIPTION, sequence, &[1]).unwrap();
        octets.truncate(7);
        octets.extend([0; 4]);
        peer.raw(&octets);
        peer.hang();
    });
    let DutError::Garbage { what } = error else { panic!("{error:?}") };
    assert!(what.contains("; a frame had the CRC 00000000 where "), "{what}");
}

#[test]
fn it_babbles_before_it_answers_and_is_understood() {
    let address = peer(|socket| {
        let mut peer = Peer { socket, decoder: Decoder::new() };
        peer.raw(&[0xF5; MAX_GARBAGE]);
        peer.describe();
        peer.hang();
    });
    assert_eq!(connect_within(&address, PATIENT).unwrap().hello(), Ok(description()));
}

#[test]
fn it_is_an_echo() {
    let error = greeted(|peer| {
        let hello = peer.next().unwrap();
        peer.send(hello.kind, hello.sequence, &hello.payload);
        peer.hang();
    });
    assert_eq!(error, garbage("message 01, which only a harness sends"));
}

#[rstest]
#[case::older(0)]
#[case::newer(2)]
fn it_speaks_another_version(#[case] theirs: u8) {
    let error = greeted(move |peer| {
        let sequence = peer.next().unwrap().sequence;
        peer.send(DESCRIPTION, sequence, &[theirs, 0xFF, 0xFF, 0xFF]);
        peer.hang();
    });
    assert_eq!(error, DutError::Version { theirs, ours: VERSION });
}

#[test]
fn it_answers_something_else() {
    let answer = |kind, by, payload: &'static [u8]| {
        greeted(move |peer| {
            let sequence = peer.next().unwrap().sequence;
            peer.send(kind, sequence.wrapping_add(by), payload);
            peer.hang();
        })
    };
    assert_eq!(answer(DESCRIPTION, 1, &[1]), contract("it answered sequence number 1 where 0 is due"));
    assert_eq!(answer(OBSERVED, 0, &[0]), contract("it answered message 82 where 81 is due"));
    assert_eq!(answer(0x77, 0, &[]), garbage("unknown message 77"));
    assert_eq!(answer(DESCRIPTION, 0, &[]), garbage("the payload ends within the version"));
    assert_eq!(answer(ERROR, 9, b"no \x1b[31m way"), contract(r#"it reported "no \u{1b}[31m way""#));
}

#[test]
fn it_describes_what_cannot_be() {
    let describes = |change: fn(&mut fsct_adapters::Description)| {
        let mut changed = description();
        change(&mut changed);
        greeted(move |peer| {
            let sequence = peer.next().unwrap().sequence;
            peer.send(DESCRIPTION, sequence, &pack_description(&changed, Limits::LEAST));
            peer.hang();
        })
    };
    assert_eq!(describes(|it| it.ports = 2), contract("an FS-device with 2 ports"));
    assert_eq!(describes(|it| (it.role, it.ports) = (Role::Master, 0)), contract("an FS-master with 0 ports"));
    assert_eq!(describes(|it| it.offers.clear()), contract("it offers nothing it can be configured as"));
    let too_much = contract("it offers 0 to 4 octets with crc16, which holds 3");
    assert_eq!(describes(|it| it.offers[0].pd_out.1 = 4), too_much);
    let backwards = contract("it offers 3 to 2 octets with crc16, which holds 3");
    assert_eq!(describes(|it| it.offers.push(Offer { pd_in: (3, 2), ..it.offers[0] })), backwards);
}

fn image(stimulus: u16, port: u8) -> Observation {
    seen(stimulus, 0, Seen::Image { port, octets: None })
}

fn read() -> Stimulus {
    Stimulus::Read { index: 0x10, subindex: 0 }
}

fn write() -> Stimulus {
    Stimulus::Write { index: 0x10, subindex: 0, data: vec![] }
}

#[rstest]
#[case::no_image(exchange(&[1]), vec![], "no image, stimulus 0 (exchange)")]
#[case::two_images(exchange(&[1]), vec![image(0, 1), image(0, 1)], "an observation comes after the image, stimulus 0 (exchange)")]
#[case::late(exchange(&[1]), vec![image(0, 1), seen(0, 0, Seen::Unsupported)], "an observation comes after the image, stimulus 0 (exchange)")]
#[case::another_port(exchange(&[1]), vec![image(0, 2)], "the image is on port 2, the exchange on port 1, stimulus 0 (exchange)")]
#[case::image_unasked(Stimulus::Power(true), vec![image(0, 1)], "an image that was not asked for, stimulus 0 (power)")]
#[case::read_unanswered(read(), vec![], "no answer, stimulus 0 (read)")]
#[case::read_twice(read(), vec![seen(0, 0, Seen::Unsupported), seen(0, 0, Seen::Value(vec![]))], "a second answer, stimulus 0 (read)")]
#[case::read_written(read(), vec![seen(0, 0, Seen::Written)], "an answer that was not asked for, stimulus 0 (read)")]
#[case::write_unanswered(write(), vec![], "no answer, stimulus 0 (write)")]
#[case::write_read(write(), vec![seen(0, 0, Seen::Value(vec![]))], "an answer that was not asked for, stimulus 0 (write)")]
#[case::answer_unasked(Stimulus::Advance { ns: 1 }, vec![seen(0, 0, Seen::Refused { error: 1 })], "an answer that was not asked for, stimulus 0 (advance)")]
#[case::smi_unanswered(smi(SmiService::PdIn), vec![], "no answer, stimulus 0 (smi)")]
#[case::smi_twice(smi(SmiService::PdIn), vec![result(0), result(0)], "a second answer, stimulus 0 (smi)")]
#[case::smi_unsupported_and_answered(smi(SmiService::PdIn), vec![seen(0, 0, Seen::Unsupported), result(0)], "a second answer, stimulus 0 (smi)")]
#[case::smi_unsupported_twice(smi(SmiService::PdIn), vec![seen(0, 0, Seen::Unsupported); 2], "a second answer, stimulus 0 (smi)")]
#[case::smi_read(smi(SmiService::PdIn), vec![seen(0, 0, Seen::Value(vec![]))], "an answer that was not asked for, stimulus 0 (smi)")]
#[case::smi_imaged(smi(SmiService::PdIn), vec![image(0, 1)], "an image that was not asked for, stimulus 0 (smi)")]
#[case::smi_answered_late(smi(SmiService::PdIn), vec![result(1)], "no answer, stimulus 0 (smi)")]
#[case::result_unasked(Stimulus::Plug { port: 1, device: None }, vec![result(0)], "an answer that was not asked for, stimulus 0 (plug)")]
#[case::result_of_a_read(read(), vec![result(0)], "an answer that was not asked for, stimulus 0 (read)")]
#[case::respond_written(Stimulus::Respond { port: 1, response: Response::Written }, vec![seen(0, 0, Seen::Written)], "an answer that was not asked for, stimulus 0 (respond)")]
#[case::raise_unsupported_twice(Stimulus::Raise { port: 1, code: 0, qualifier: 0 }, vec![seen(0, 0, Seen::Unsupported); 2], "\"unsupported\" is said twice, stimulus 0 (raise)")]
#[case::drive_imaged(Stimulus::Drive { port: 1, line: Line::Cq, level: true }, vec![image(0, 1)], "an image that was not asked for, stimulus 0 (drive)")]
#[case::half_a_pulse(Stimulus::Power(true), vec![seen(0, 0, Seen::Line { port: 1, line: Line::WakeUp, level: false })], "a wake-up pulse of level 0, stimulus 0 (power)")]
#[case::mode_after_image(exchange(&[1]), vec![image(0, 1), seen(0, 0, Seen::Mode { port: 1, mode: Mode::Inactive })], "an observation comes after the image, stimulus 0 (exchange)")]
#[case::said_twice(Stimulus::Other { kind: 200, octets: vec![] }, vec![seen(0, 0, Seen::Unsupported); 2], "\"unsupported\" is said twice, stimulus 0 (unknown kind)")]
#[case::out_of_range(Stimulus::Power(true), vec![seen(2, 0, Seen::Unsupported)], "an observation of stimulus 2 in a request of 2")]
#[case::backwards(Stimulus::Power(true), vec![image(1, 1), seen(0, 0, Seen::Unsupported)], "an observation of stimulus 0 comes after one, stimulus 1 (exchange)")]
fn it_breaks_the_contract(#[case] stimulus: Stimulus, #[case] answer: Vec<Observation>, #[case] what: &str) {
    // A well-behaved exchange follows, so that what is missing is missed in the middle of a request too.
    let complete = answer.iter().any(|observation| observation.stimulus > 0);
    let rest = if complete { vec![] } else { vec![image(1, 1)] };
    let answers = [answer, rest].concat();
    let (outcome, _) = applied(&[stimulus, exchange(&[2])], move |peer, sequence| peer.observed(sequence, &answers));
    assert_eq!(outcome, Err(contract(what)));
}

fn result(stimulus: u16) -> Observation {
    seen(stimulus, 0, Seen::Smi(Box::new(status(2, 0x0102))))
}

#[test]
fn an_fs_master_may_say_what_happens_on_its_ports_during_any_stimulus() {
    let happens = [
        Seen::Line { port: 1, line: Line::Power, level: false },
        Seen::Line { port: 1, line: Line::WakeUp, level: true },
        Seen::Mode { port: 1, mode: Mode::Startup },
        Seen::Request { port: 1, index: 0x4202, subindex: 0, data: None },
        Seen::Indication { port: 1, source: Source::Port, qualifier: 0x74, code: 0x2002 },
    ];
    let during = |stimulus: u16| happens.clone().map(|seen_| seen(stimulus, 0, seen_)).to_vec();
    let respond = Stimulus::Respond { port: 1, response: Response::Refused(0x8022) };
    let stimuli = [respond, smi(SmiService::PdIn), read(), exchange(&[1])];
    let answers = [
        during(0),
        during(1),
        vec![result(1)],
        during(1),
        vec![seen(2, 0, Seen::Unsupported)],
        during(2),
        during(3),
        vec![image(3, 1)],
    ]
    .concat();
    let expected = answers.clone();
    let (outcome, observed) = applied(&stimuli, move |peer, sequence| peer.observed(sequence, &answers));
    assert_eq!((outcome, observed), (Ok(()), expected));
}

#[test]
fn what_is_missing_at_the_end_is_missed() {
    let (outcome, observed) =
        applied(&[exchange(&[1]), exchange(&[2])], |peer, sequence| peer.observed(sequence, &[image(0, 1)]));
    assert_eq!(outcome, Err(contract("no image, stimulus 1 (exchange)")));
    assert_eq!(observed, [image(0, 1)]);
    let stimuli = [exchange(&[1]), smi(SmiService::PdIn)];
    let (outcome, _) = applied(&stimuli, |peer, sequence| peer.observed(sequence, &[image(0, 1)]));
    assert_eq!(outcome, Err(contract("no answer, stimulus 1 (smi)")));
}

#[test]
fn what_came_before_a_fault_is_kept() {
    let (outcome, observed) = applied(&[exchange(&[1]), exchange(&[2])], |peer, sequence| {
        let mut payload = Vec::new();
        pack_observed(&[image(0, 1), image(1, 1)], 0xFFFF, &mut payload);
        let cut = payload.len() - 1;
        peer.send(OBSERVED, sequence, &payload[..cut]);
    });
    assert_eq!(outcome, Err(garbage("the payload ends within an observation")));
    assert_eq!(observed, [image(0, 1)]);
}

#[test]
fn it_may_answer_in_several_frames() {
    let service = seen(0, 5, Seen::Service { port: 1, service: Service::SetsdDc, value: Octets::bit(true) });
    let expected = [service.clone(), image(0, 1), image(1, 1)];
    let (outcome, observed) = applied(&[exchange(&[1]), exchange(&[2])], move |peer, sequence| {
        for observation in [service, image(0, 1)] {
            let mut payload = Vec::new();
            pack_observed(&[observation], 0xFFFF, &mut payload);
            payload[0] = 1;
            peer.send(OBSERVED, sequence, &payload);
        }
        peer.observed(sequence, &[image(1, 1)]);
    });
    assert_eq!(outcome, Ok(()));
    assert_eq!(observed, expected);
}

#[test]
fn it_announces_more_for_ever() {
    let (outcome, _) = applied(&[Stimulus::Power(true)], |peer, sequence| {
        while peer.socket.write_all(&encode(OBSERVED, sequence, &[1]).unwrap()).is_ok() {}
    });
    assert_eq!(outcome, Err(contract("a frame announces more observations and holds none")));
}

#[test]
fn it_floods() {
    let limit = FLOOD_PER_STIMULUS + FLOOD_SLACK;
    let (outcome, observed) = applied(&[Stimulus::Power(true)], |peer, sequence| {
        let event = seen(0, 0, Seen::Event { code: 1, qualifier: 2 });
        let mut payload = Vec::new();
        pack_observed(&vec![event; 100], 0xFFFF, &mut payload);
        payload[0] = 1;
        let octets = encode(OBSERVED, sequence, &payload).unwrap();
        while peer.socket.write_all(&octets).is_ok() {}
    });
    assert_eq!(outcome, Err(DutError::Flood { limit }));
    assert_eq!(observed.len(), limit);
}

#[test]
fn a_stimulus_too_long_for_it_is_not_sent() {
    let (outcome, _) = applied(&[Stimulus::Power(true)], |peer, sequence| peer.observed(sequence, &[]));
    assert_eq!(outcome, Ok(()));
    let address = peer(|socket| {
        let mut peer = Peer { socket, decoder: Decoder::new() };
        peer.describe();
        peer.hang();
    });
    let mut dut = connect_within(&address, PATIENT).unwrap();
    dut.hello().unwrap();
    let long = Stimulus::Write { index: 0, subindex: 0, data: vec![0; 70_000] };
    let refused = contract("it takes 512 octets at once, a stimulus has more");
    assert_eq!(dut.apply(&[long], &mut Vec::new()), Err(refused));
}

#[test]
fn a_small_dut_gets_one_small_request_at_a_time() {
    let address = peer(|socket| {
        let mut peer = Peer { socket, decoder: Decoder::new() };
        peer.describe();
        while let Some(request) = peer.next() {
            assert!(request.payload.len() <= MIN_PAYLOAD);
            // Nothing may be waiting behind a request that is not answered.
            peer.socket.set_nonblocking(true).unwrap();
            assert!(peer.socket.read(&mut [0; 1]).is_err());
            peer.socket.set_nonblocking(false).unwrap();
            let count = unpack_apply(&request.payload).unwrap().len() as u16;
            peer.observed(request.sequence, &(0..count).map(|at| image(at, 1)).collect::<Vec<_>>());
        }
    });
    let mut dut = connect_within(&address, PATIENT).unwrap();
    dut.hello().unwrap();
    let mut observed = Vec::new();
    dut.apply(&vec![exchange(&[0; 32]); 1000], &mut observed).unwrap();
    let positions: Vec<_> = observed.iter().map(|observation| observation.stimulus).collect();
    assert_eq!(positions, (0..1000).collect::<Vec<_>>());
}

#[test]
fn nobody_is_there() {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let url = format!("tcp://{}", listener.local_addr().unwrap());
    drop(listener);
    for url in [url.as_str(), "tcp://no.such.host.invalid:1", "unix:/no/such/socket", "exec:/no/such/program"] {
        let error = connect_within(&url.parse().unwrap(), SHORT).err().unwrap();
        assert_eq!(error.fault(), Fault::Rig);
        let begin = format!("{url} cannot be reached: ");
        assert!(error.to_string().starts_with(&begin), "{error}");
    }
    let inproc = connect_within(&"inproc:x".parse().unwrap(), SHORT).err().unwrap();
    let text = "inproc:x cannot be reached: it is inside a program and has no connection; \
                is the DUT running and the address right?";
    assert_eq!(inproc.to_string(), text);
}
