//! From an address to a connected DUT.

use crate::process::Process;
use crate::serial;
use crate::socket::Socket;
use crate::stream::REPLY_TIMEOUT;
use crate::{Address, Dut, DutError, StreamDut};
use std::io;
use std::net::{TcpStream, ToSocketAddrs};
use std::sync::mpsc::channel;
use std::thread;
use std::time::Duration;

/// How long the way to a socket may take, resolution of names included.
pub const CONNECT_TIMEOUT: Duration = Duration::from_secs(2);

/// Reaches the DUT at an address; each frame it answers has to come within the time-out of the address, or within
/// [`REPLY_TIMEOUT`].
///
/// # Errors
/// [`DutError::Unreachable`]; always so for `inproc:`, which the harness itself resolves, and for `lib:`, which it makes a
/// process for.
pub fn connect(address: &Address) -> Result<Box<dyn Dut>, DutError> {
    connect_within(address, REPLY_TIMEOUT)
}

/// As [`connect`], with another time-out where the address states none.
///
/// # Errors
/// As [`connect`].
pub fn connect_within(address: &Address, reply: Duration) -> Result<Box<dyn Dut>, DutError> {
    let unreachable = |error: io::Error| DutError::Unreachable { url: address.to_string(), why: error.to_string() };
    match address {
        Address::Inproc { .. } => Err(unreachable(io::Error::other("it is inside a program and has no connection"))),
        Address::Lib { .. } => Err(unreachable(io::Error::other("it takes a process made for it, as fsct does"))),
        Address::Exec { program, args } => {
            let (reader, writer, process) = Process::start(program, args).map_err(unreachable)?;
            Ok(Box::new(StreamDut::new(reader, writer, Box::new(process), reply)))
        }
        Address::Serial { path, options } => {
            let dut = serial::connect(path, options, options.timeout.unwrap_or(reply)).map_err(unreachable)?;
            Ok(Box::new(dut))
        }
        Address::Tcp { timeout, .. } | Address::Unix { timeout, .. } => {
            let socket = open(address).map_err(unreachable)?;
            let reader = socket.try_clone().map_err(unreachable)?;
            let writer = socket.try_clone().map_err(unreachable)?;
            Ok(Box::new(StreamDut::new(reader, writer, Box::new(socket), timeout.unwrap_or(reply))))
        }
    }
}

/// Opens a socket in time. Neither the resolver nor a local socket knows a time-out, so that a thread of its own waits
/// for them; it ends when they do.
fn open(address: &Address) -> io::Result<Socket> {
    let (done, outcome) = channel();
    let address = address.clone();
    thread::spawn(move || done.send(open_now(&address)));
    let late = || io::Error::new(io::ErrorKind::TimedOut, format!("no connection within {CONNECT_TIMEOUT:?}"));
    outcome.recv_timeout(CONNECT_TIMEOUT).unwrap_or_else(|_| Err(late()))
}

fn open_now(address: &Address) -> io::Result<Socket> {
    match address {
        Address::Tcp { host, port, .. } => {
            let mut outcome = Err(io::Error::other("the name of the host has no address"));
            for place in (host.as_str(), *port).to_socket_addrs()? {
                outcome = TcpStream::connect_timeout(&place, CONNECT_TIMEOUT);
                if outcome.is_ok() {
                    break;
                }
            }
            let stream = outcome?;
            // Requests and answers are small and wait for each other.
            stream.set_nodelay(true)?;
            Ok(Socket::Tcp(stream))
        }
        #[cfg(unix)]
        Address::Unix { path, .. } => std::os::unix::net::UnixStream::connect(path).map(Socket::Unix),
        _ => Err(io::Error::new(io::ErrorKind::Unsupported, "this system has no such sockets")),
    }
}
