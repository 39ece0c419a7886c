//! `fsct simulate device`: the reference FS-Device as a DUT in another process.

use super::{RIG, USAGE, fail};
use fsct_adapters::{Address, AddressError, Dut, Listener, serve};
use fsct_reference::{FsDevice, Options};

/// Arguments of `fsct simulate`.
#[derive(clap::Args, Debug)]
pub struct Args {
    /// What to be
    role: Role,
    /// Where to be reached: tcp://HOST:PORT (port 0: any), unix:PATH or stdio
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
}

#[derive(Copy, Clone, Debug, clap::ValueEnum)]
enum Role {
    Device,
}

/// Runs the command; the result is the exit code.
pub fn run(args: &Args) -> u8 {
    let Role::Device = args.role;
    let mut query = Vec::new();
    let mut option = |name: &str, value: Option<String>| query.extend(value.map(|value| (name.to_owned(), value)));
    option("mutant", args.mutant.clone());
    option("latency", args.latency.map(|latency| latency.to_string()));
    option("clock", args.clock.clone());
    let options = match Options::from_query(&query) {
        Ok(options) => options,
        Err(error) => return fail(USAGE, error),
    };
    let listener = match listen(&args.listen) {
        Ok(listener) => listener,
        Err(why) => return fail(USAGE, why),
    };
    // On stdout the frames themselves may go.
    match listener.address() {
        Ok(address) => eprintln!("reference FS-Device at {address}"),
        Err(_) => eprintln!("reference FS-Device on stdin and stdout"),
    }
    match serve(&listener, &|| -> Box<dyn Dut> { Box::new(FsDevice::new(options)) }) {
        Ok(()) => 0,
        Err(error) => fail(RIG, error),
    }
}

fn listen(place: &str) -> Result<Listener, String> {
    if place == "stdio" {
        return Ok(Listener::stdio());
    }
    let address: Address = place.parse().map_err(|error: AddressError| error.to_string())?;
    Listener::bind(&address).map_err(|error| error.to_string())
}
