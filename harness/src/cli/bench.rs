//! From an address to a DUT that has said hello.

use crate::campaign::Bench;
use crate::problem::suggestion;
use fsct_adapters::{Address, Dut, DutError, Monotonic, REPLY_TIMEOUT, connect_within};
use fsct_reference::{
    ConstantDevice, ConstantMaster, EchoDevice, EchoMaster, FsDevice, FsMaster, Gateway, GatewayOptions, MasterOptions,
    NullDevice, NullMaster, Options,
};
use std::io;
use std::path::Path;

/// How often a line that loses octets is tried.
const TRIES: usize = 3;

/// What `inproc:` can reach.
const IN_PROCESS: [&str; 9] = [
    "reference-device",
    "reference-master",
    "reference-gateway",
    "null-device",
    "echo-device",
    "constant-device",
    "null-master",
    "echo-master",
    "constant-master",
];

/// A usable address: for `inproc:` the name and every option are known.
///
/// # Errors
/// One sentence for the user.
pub fn parse(text: &str) -> Result<Address, String> {
    let address: Address = text.parse().map_err(|error: fsct_adapters::AddressError| error.to_string())?;
    if let Address::Inproc { name, query } = &address {
        in_process(name, query)?;
    }
    Ok(address)
}

/// A fresh connection, greeted.
///
/// # Errors
/// [`DutError`] when the DUT is not reached or fails the preflight.
pub fn connect(address: &Address) -> Result<Bench, DutError> {
    match address {
        Address::Serial { .. } => connect_line(address),
        address => Bench::greet(reach(address)?)?.prove(&mut Monotonic::default()),
    }
}

/// A fresh connection on which nothing has been said.
///
/// # Errors
/// [`DutError::Unreachable`].
pub fn reach(address: &Address) -> Result<Box<dyn Dut>, DutError> {
    match address {
        Address::Inproc { name, query } => {
            in_process(name, query).map_err(|why| DutError::Unreachable { url: address.to_string(), why })
        }
        Address::Lib { path, timeout } => {
            let host =
                host(path).map_err(|why| DutError::Unreachable { url: address.to_string(), why: why.to_string() })?;
            connect_within(&host, timeout.unwrap_or(REPLY_TIMEOUT))
        }
        address => fsct_adapters::connect(address),
    }
}

/// This program once more, to load a library: what the library does to it ends it, and not the run.
fn host(path: &Path) -> io::Result<Address> {
    let path = path.canonicalize()?;
    let text = |path: &Path| path.to_str().map(str::to_owned).ok_or(io::Error::other("the path is no UTF-8"));
    Ok(Address::Exec {
        program: text(&std::env::current_exe()?)?,
        args: vec![super::host::NAME.to_owned(), text(&path)?],
    })
}

/// As [`connect`], over a line that can lose octets, and measured: jitter is large there and not ours to forget. Nothing said
/// until then makes a DUT do anything, so a loss costs another try. A DUT that does not say hello has been asked often
/// enough.
fn connect_line(address: &Address) -> Result<Bench, DutError> {
    let mut repeats = 1..TRIES;
    loop {
        let mut dut = fsct_adapters::connect(address)?;
        dut.hello()?;
        let proved = Bench::greet(dut).and_then(|bench| bench.prove(&mut Monotonic::default()));
        match proved.and_then(Bench::measure) {
            Err(DutError::Timeout { .. } | DutError::Line { .. }) if repeats.next().is_some() => {}
            outcome => return outcome,
        }
    }
}

fn in_process(name: &str, query: &[(String, String)]) -> Result<Box<dyn Dut>, String> {
    if !IN_PROCESS.contains(&name) {
        return Err(format!("there is no `inproc:{name}`; {}", suggestion(name, IN_PROCESS)));
    }
    if !name.starts_with("reference-") && !query.is_empty() {
        return Err(format!("`inproc:{name}` takes no options"));
    }
    Ok(match name {
        "null-device" => Box::<NullDevice>::default(),
        "echo-device" => Box::<EchoDevice>::default(),
        "constant-device" => Box::<ConstantDevice>::default(),
        "null-master" => Box::<NullMaster>::default(),
        "echo-master" => Box::<EchoMaster>::default(),
        "constant-master" => Box::<ConstantMaster>::default(),
        "reference-gateway" => {
            Box::new(Gateway::new(GatewayOptions::from_query(query).map_err(|error| error.to_string())?))
        }
        "reference-master" => {
            Box::new(FsMaster::new(MasterOptions::from_query(query).map_err(|error| error.to_string())?))
        }
        _ => Box::new(FsDevice::new(Options::from_query(query).map_err(|error| error.to_string())?)),
    })
}
