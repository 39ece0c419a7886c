//! `fsct simulate`: the reference FS-Device or FS-Master as a DUT in another process.

use super::{RIG, USAGE, fail};
use crate::tape::Tape;
use fsct_adapters::{Address, AddressError, Dut, Listener, Role as Side, serve};
use fsct_reference::{FsDevice, FsMaster, MasterOptions, Options};
use std::path::{Path, PathBuf};

/// Arguments of `fsct simulate`.
#[derive(clap::Args, Debug)]
pub struct Args {
    /// What to be
    role: Role,
    /// Where to be reached: tcp://HOST:PORT (port 0: any), unix:PATH, pty or stdio
    #[arg(long, value_name = "URL")]
    listen: String,
    /// Be wrong in this way
    #[arg(long, value_name = "NAME")]
    mutant: Option<String>,
    /// Exchanges an answer takes to appear
    #[arg(long, value_name = "N")]
    latency: Option<u8>,
    /// Clock: virtual or real
    #[arg(long, value_name = "CLOCK")]
    clock: Option<String>,
    /// Ports of an FS-Master
    #[arg(long, value_name = "N")]
    ports: Option<u8>,
    /// Width of the Ready pulse of an FS-Device in microseconds
    #[arg(long, value_name = "US")]
    pulse_us: Option<u32>,
    /// Write the lines of port 1 to this file, for `fsct capture` or a viewer
    #[arg(long, value_name = "FILE")]
    vcd: Option<PathBuf>,
}

#[derive(Copy, Clone, Debug, clap::ValueEnum)]
enum Role {
    Device,
    Master,
}

/// Runs the command; the result is the exit code.
pub fn run(args: &Args) -> u8 {
    let mut query = Vec::new();
    let mut option = |name: &str, value: Option<String>| query.extend(value.map(|value| (name.to_owned(), value)));
    option("mutant", args.mutant.clone());
    option("latency", args.latency.map(|latency| latency.to_string()));
    option("clock", args.clock.clone());
    option("pulse_us", args.pulse_us.map(|us| us.to_string()));
    option("ports", args.ports.map(|ports| ports.to_string()));
    match args.role {
        Role::Device => match Options::from_query(&query) {
            Ok(options) => serve_on(args, "FS-Device", Side::Device, &|| Box::new(FsDevice::new(options))),
            Err(error) => fail(USAGE, error),
        },
        Role::Master => match MasterOptions::from_query(&query) {
            Ok(options) => serve_on(args, "FS-Master", Side::Master, &|| Box::new(FsMaster::new(options))),
            Err(error) => fail(USAGE, error),
        },
    }
}

fn serve_on(args: &Args, what: &str, side: Side, make: &(dyn Fn() -> Box<dyn Dut> + Sync)) -> u8 {
    let listener = match listen(&args.listen) {
        Ok(listener) => listener,
        Err(why) => return fail(USAGE, why),
    };
    // On stdout the frames themselves may go.
    match listener.address() {
        Ok(address) => eprintln!("reference {what} at {address}"),
        Err(_) => eprintln!("reference {what} on stdin and stdout"),
    }
    let served = match &args.vcd {
        None => serve(&listener, make),
        Some(path) => match tape(path, make) {
            Ok(tape) => serve(&listener, &|| tape.over(make(), side)),
            Err(why) => return fail(USAGE, why),
        },
    };
    match served {
        Ok(()) => 0,
        Err(error) => fail(RIG, error),
    }
}

/// The file the lines are written to, with what the DUT says of its clock.
fn tape(path: &Path, make: &(dyn Fn() -> Box<dyn Dut> + Sync)) -> Result<Tape, String> {
    let clock = make().hello().map_err(|error| error.to_string())?.clock;
    Tape::create(path, clock.uncertainty_ns).map_err(|error| format!("{} cannot be written: {error}", path.display()))
}

fn listen(place: &str) -> Result<Listener, String> {
    if place == "stdio" {
        return Ok(Listener::stdio());
    }
    #[cfg(unix)]
    if place == "pty" {
        return Listener::pty().map_err(|error| format!("there is no pseudo-terminal: {error}"));
    }
    let address: Address = place.parse().map_err(|error: AddressError| error.to_string())?;
    Listener::bind(&address).map_err(|error| error.to_string())
}
