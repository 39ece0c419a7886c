//! Exchanges per second: the bare reference DUTs, the same with session, recorder and oracle around them, and over TCP on
//! loopback; the whole suites; loading and checking all cases.

use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use fsct_adapters::{
    Dut, Line, Listener, Observation, Octets, Response, Role, SmiRequest, SmiService, Stimulus, Variant, connect, serve,
};
use fsct_harness::campaign::{Bench, Judges, Run};
use fsct_harness::case::model::Configure;
use fsct_harness::library::Library;
use fsct_harness::oracle::Setup;
use fsct_harness::plan::{Selection, plan};
use fsct_harness::portconfig;
use fsct_harness::session::{Session, Stop};
use fsct_protocol::crc::Reading;
use fsct_protocol::fsp::{Authenticity, Protocol, VerifyRecord};
use fsct_protocol::spdu::{Control, InSpdu, OutSpdu, Pd, Port, Status, inv3, succ};
use fsct_protocol::{Edition, ProtMode};
use fsct_reference::{FsDevice, FsMaster, MasterOptions, Options};
use std::convert::Infallible;
use std::sync::atomic::AtomicBool;

const EXCHANGES: usize = 10_000;
const MODES: [ProtMode; 2] = [ProtMode::Crc16, ProtMode::Crc32];
const CYCLE_NS: u64 = 1_000_000;

fn main() {
    divan::main();
}

fn variant(mode: ProtMode) -> Variant {
    let pd = mode.max_pd() as u8;
    Variant { edition: Edition::Iec2022, mode, pd_out: pd, pd_in: pd }
}

/// SPDUs of a running FS-Master: the first, then EXCHANGES more with the counter going round.
fn spdus(mode: ProtMode) -> Vec<Octets> {
    let mut mcount = 0;
    (0..=EXCHANGES)
        .map(|at| {
            let control = Control { mcount, set_sd: at == 0, ch_f_ack_req: false };
            mcount = succ(mcount);
            let pd = Pd::new(&vec![at as u8 | 1; mode.max_pd()]).expect("it fits");
            let spdu = OutSpdu { pd, port: Port::ONE, control };
            Octets::new(spdu.wire().emit(mode, Reading::Preset).octets()).expect("it fits")
        })
        .collect()
}

/// On-request data that start the SCL.
fn start(dut: &mut dyn Dut, mode: ProtMode) -> Vec<Stimulus> {
    let mut observed = Vec::new();
    let stimuli =
        [Stimulus::Configure(variant(mode)), Stimulus::Power(true), Stimulus::Read { index: 0x4201, subindex: 4 }];
    dut.apply(&stimuli, &mut observed).expect("the reference device answers");
    let io = observed.iter().find_map(|seen| match &seen.seen {
        fsct_adapters::Seen::Value(data) => Some(u16::from_be_bytes([data[0], data[1]])),
        _ => None,
    });
    let authenticity = Authenticity { authenticity_1: 1, authenticity_2: 0, port: 1 };
    let protocol = Protocol {
        version: 1,
        mode: mode.code(),
        watchdog_ms: 20,
        io_struct_crc: io.expect("it was read"),
        tech_par_crc: 0,
    };
    let record = VerifyRecord { authenticity, protocol };
    let write = |index, data: &[u8]| Stimulus::Write { index, subindex: 0, data: data.to_vec() };
    vec![
        write(0x4200, &authenticity.to_octets()),
        write(0x4201, &protocol.to_octets()),
        write(0x4202, &record.to_octets()),
    ]
}

#[divan::bench(args = MODES)]
fn bare_reference_device(bencher: Bencher, mode: ProtMode) {
    let spdus = spdus(mode);
    bencher
        .counter(ItemsCount::new(EXCHANGES))
        .with_inputs(|| {
            let mut dut = FsDevice::new(Options::default());
            let start = start(&mut dut, mode);
            dut.apply(&start, &mut Vec::new()).expect("it answers");
            dut
        })
        .bench_values(|mut dut| {
            let mut observed: Vec<Observation> = Vec::new();
            for octets in &spdus {
                observed.clear();
                let exchange = Stimulus::Exchange { port: 1, octets: Some(*octets) };
                dut.apply(&[Stimulus::Advance { ns: CYCLE_NS }, exchange], &mut observed).expect("it answers");
            }
            black_box(observed.len())
        });
}

/// A setup in which everything is judged.
fn setup(library: &Library, role: Role, mode: ProtMode) -> Setup {
    let profile = &library.profiles[&format!("reference-{role}")];
    Setup {
        role,
        edition: Edition::Iec2022,
        mode,
        pd_out: mode.max_pd(),
        pd_in: mode.max_pd(),
        port: Port::ONE,
        reading: Reading::Preset,
        cycle_ns: CYCLE_NS,
        watchdog_ns: profile.watchdog_ns(),
        tick_ns: 0,
        margin_ns: profile.margin_ns(),
        uncertainty_ns: 0,
        latency: 0,
        scl_start_ns: 0,
        allowed: library.tolerances.in_force(),
        app: true,
    }
}

/// Starts the SCL of a DUT and exchanges with oracle and recorder: SPDUs one by one, or the last one over and over in
/// large batches.
fn judged(dut: &mut dyn Dut, library: &Library, mode: ProtMode, spdus: &[Octets], batched: bool) -> usize {
    let interrupted = AtomicBool::new(false);
    let description = dut.hello().expect("it answers");
    dut.apply(&[Stimulus::Power(false)], &mut Vec::new()).expect("it answers");
    let records = start(dut, mode);
    let profile = &library.profiles["reference-device"];
    let mut session = Session::new(dut, &description, profile, vec![setup(library, Role::Device, mode)], &interrupted);
    let went: Result<(), Stop> = (|| {
        session.power(false)?;
        session.power(true)?;
        for record in records {
            session.acyclic(record)?;
        }
        let now = session.now;
        session.link_mut().oracle.parameterized(now);
        if batched {
            session.exchange_until(spdus.len() as u64 * CYCLE_NS, spdus.first().copied())?;
        } else {
            for octets in spdus {
                session.exchange(Some(*octets))?;
            }
        }
        Ok(())
    })();
    went.expect("the reference device conforms");
    session.recorded()
}

#[divan::bench(args = MODES)]
fn with_oracle_and_recorder(bencher: Bencher, mode: ProtMode) {
    let (spdus, library) = (spdus(mode), Library::embedded().expect("it is sound"));
    bencher.counter(ItemsCount::new(EXCHANGES)).bench(|| {
        let mut dut = FsDevice::new(Options::default());
        black_box(judged(&mut dut, &library, mode, &spdus, false))
    });
}

/// Answers of a running FS-Device: to the first SPDU, then EXCHANGES more with the counter going round.
fn answers(mode: ProtMode) -> Vec<Octets> {
    let mut mcount = 0;
    (0..=EXCHANGES)
        .map(|at| {
            let status = Status { dcount_i: inv3(mcount), ..Status::default() };
            mcount = succ(mcount);
            let pd = Pd::new(&vec![at as u8 | 1; mode.max_pd()]).expect("it fits");
            let spdu = InSpdu { pd, port: Port::ONE, status };
            Octets::new(spdu.wire().emit(mode, Reading::Preset).octets()).expect("it fits")
        })
        .collect()
}

/// What brings port 1 of an FS-Master to OPERATE.
fn bring_up(library: &Library, mode: ProtMode) -> Vec<Stimulus> {
    let (setup, profile) = (setup(library, Role::Master, mode), &library.profiles["reference-master"]);
    let list = portconfig::list(&setup, profile, &Configure::default());
    let request =
        SmiRequest { service: SmiService::PortConfiguration, port: 1, client_id: 1, expected: 0xFFF0, octets: list };
    let drive = |level| Stimulus::Drive { port: 1, line: Line::Cq, level };
    vec![
        Stimulus::Plug { port: 1, device: Some(portconfig::identity(&setup, profile, (0, 0))) },
        Stimulus::Smi(Box::new(request)),
        drive(true),
        Stimulus::Advance { ns: 750_000 },
        drive(false),
        Stimulus::Advance { ns: CYCLE_NS },
        Stimulus::Respond { port: 1, response: Response::Written },
    ]
}

#[divan::bench(args = MODES)]
fn bare_reference_master(bencher: Bencher, mode: ProtMode) {
    let (answers, library) = (answers(mode), Library::embedded().expect("it is sound"));
    let start = bring_up(&library, mode);
    bencher
        .counter(ItemsCount::new(EXCHANGES))
        .with_inputs(|| {
            let mut dut = FsMaster::new(MasterOptions::default());
            dut.apply(&[Stimulus::Configure(variant(mode)), Stimulus::Power(true)], &mut Vec::new())
                .expect("it answers");
            dut.apply(&start, &mut Vec::new()).expect("it answers");
            dut
        })
        .bench_values(|mut dut| {
            let mut observed: Vec<Observation> = Vec::new();
            for octets in &answers {
                observed.clear();
                let exchange = Stimulus::Exchange { port: 1, octets: Some(*octets) };
                dut.apply(&[Stimulus::Advance { ns: CYCLE_NS }, exchange], &mut observed).expect("it answers");
            }
            black_box(observed.len())
        });
}

#[divan::bench(args = MODES)]
fn master_with_oracle_and_recorder(bencher: Bencher, mode: ProtMode) {
    let (answers, library) = (answers(mode), Library::embedded().expect("it is sound"));
    let start = bring_up(&library, mode);
    let profile = &library.profiles["reference-master"];
    bencher.counter(ItemsCount::new(EXCHANGES)).bench(|| {
        let mut dut = FsMaster::new(MasterOptions::default());
        let description = dut.hello().expect("it answers");
        dut.apply(&[Stimulus::Configure(variant(mode))], &mut Vec::new()).expect("it answers");
        let interrupted = AtomicBool::new(false);
        let setups = vec![setup(&library, Role::Master, mode)];
        let mut session = Session::new(&mut dut, &description, profile, setups, &interrupted);
        session.link_mut().starts = Some(true);
        let went: Result<(), Stop> = (|| {
            session.power(true)?;
            for stimulus in &start {
                session.act(stimulus.clone())?;
            }
            for octets in &answers {
                session.exchange(Some(*octets))?;
            }
            Ok(())
        })();
        went.expect("the reference master conforms");
        assert!(session.link().app.qualifier == Some(true), "it does not operate");
        black_box(session.recorded())
    });
}

#[divan::bench(args = [false, true], sample_count = 10)]
fn over_tcp_batched(bencher: Bencher, batched: bool) {
    let mode = ProtMode::Crc32;
    let (spdus, library) = (spdus(mode), Library::embedded().expect("it is sound"));
    let address = "tcp://127.0.0.1:0".parse().expect("an address");
    let listener = Listener::bind(&address).expect("loopback");
    let address = listener.address().expect("it is bound");
    std::thread::spawn(move || serve(&listener, &|| -> Box<dyn Dut> { Box::new(FsDevice::new(Options::default())) }));
    let mut dut = connect(&address).expect("loopback");
    bencher
        .counter(ItemsCount::new(EXCHANGES))
        .bench_local(|| black_box(judged(dut.as_mut(), &library, mode, &spdus, batched)));
}

#[divan::bench(args = ["device", "master"], sample_count = 10)]
fn whole_suite(bencher: Bencher, role: &str) {
    let library = Library::embedded().expect("it is sound");
    let profile = &library.profiles[&format!("reference-{role}")];
    let interrupted = AtomicBool::new(false);
    let connect = || {
        Bench::greet(match role {
            "device" => Box::new(FsDevice::new(Options::default())) as Box<dyn Dut>,
            _ => Box::new(FsMaster::new(MasterOptions::default())),
        })
    };
    let description = connect().expect("it answers").description;
    let plan = plan(&library, &Selection::default(), profile, &description).expect("a plan");
    let run = Run {
        library: &library,
        profile,
        allowed: library.tolerances.in_force(),
        seed: 1,
        command: String::new(),
        interrupted: &interrupted,
        judges: Judges::default(),
    };
    bencher.counter(ItemsCount::new(plan.cases.len())).bench(|| {
        let mut cases = 0;
        let kept = run.execute(&plan, connect(), connect, |case| {
            cases += case.trace.len();
            Ok::<(), Infallible>(())
        });
        kept.expect("keeping cannot fail");
        black_box(cases)
    });
}

#[divan::bench(sample_count = 10)]
fn load_and_check_everything(bencher: Bencher) {
    bencher.bench(|| black_box(Library::embedded().expect("it is sound").check().len()));
}
