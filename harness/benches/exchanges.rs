//! Exchanges per second: the bare reference FS-Device, and the same with session, trace and oracle around it; the
//! whole device suite; a long run.

use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use fsct_adapters::{Dut, Observation, Octets, Stimulus, Variant};
use fsct_harness::campaign::{Bench, Run};
use fsct_harness::library::Library;
use fsct_harness::oracle::{DeviceOracle, Setup};
use fsct_harness::plan::{Selection, plan};
use fsct_harness::session::Session;
use fsct_protocol::crc::Reading;
use fsct_protocol::fsp::{Authenticity, Protocol, VerifyRecord};
use fsct_protocol::spdu::{Control, OutSpdu, Pd, Port, succ};
use fsct_protocol::{Edition, ProtMode};
use fsct_reference::{FsDevice, Options};
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
fn start(dut: &mut FsDevice, mode: ProtMode) -> Vec<Stimulus> {
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

#[divan::bench(args = MODES)]
fn with_oracle_and_trace(bencher: Bencher, mode: ProtMode) {
    let spdus = spdus(mode);
    let library = Library::embedded().expect("it is sound");
    let profile = &library.profiles["reference-device"];
    let setup = Setup {
        edition: Edition::Iec2022,
        mode,
        pd_out: mode.max_pd(),
        pd_in: mode.max_pd(),
        port: Port::ONE,
        reading: Reading::Preset,
        watchdog_ns: profile.watchdog_ns(),
        tick_ns: 0,
        margin_ns: profile.margin_ns(),
        uncertainty_ns: 0,
        latency: 0,
        scl_start_ns: 0,
        allowed: library.tolerances.in_force(),
        app: true,
    };
    let interrupted = AtomicBool::new(false);
    bencher.counter(ItemsCount::new(EXCHANGES)).bench(|| {
        let mut dut = FsDevice::new(Options::default());
        let description = dut.hello().expect("it answers");
        let records = start(&mut dut, mode);
        let mut session = Session::new(&mut dut, &description, profile, DeviceOracle::new(setup.clone()), &interrupted);
        let went: Result<(), fsct_harness::session::Stop> = (|| {
            session.power(false)?;
            session.power(true)?;
            for record in &records {
                session.acyclic(record.clone())?;
            }
            session.oracle.parameterized(session.now);
            for octets in &spdus {
                session.exchange(Some(*octets))?;
            }
            Ok(())
        })();
        went.expect("the reference device conforms");
        black_box(session.recorded())
    });
}

#[divan::bench(sample_count = 10)]
fn whole_device_suite(bencher: Bencher) {
    let library = Library::embedded().expect("it is sound");
    let profile = &library.profiles["reference-device"];
    let interrupted = AtomicBool::new(false);
    let connect = || Bench::greet(Box::new(FsDevice::new(Options::default())));
    let description = connect().expect("it answers").description;
    let plan = plan(&library, &Selection::default(), profile, &description).expect("a plan");
    let run = Run {
        library: &library,
        profile,
        allowed: library.tolerances.in_force(),
        seed: 1,
        command: String::new(),
        interrupted: &interrupted,
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
