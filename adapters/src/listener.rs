//! Where a DUT waits for a harness.

use crate::Address;
#[cfg(unix)]
use crate::SerialOptions;
#[cfg(unix)]
use crate::serial::pty::Pty;
use crate::socket::Socket;
use std::io;
use std::net::{IpAddr, Ipv4Addr, Ipv6Addr, SocketAddr, TcpListener, TcpStream, ToSocketAddrs};
#[cfg(unix)]
use std::os::unix::{
    fs::FileTypeExt,
    net::{UnixListener, UnixStream},
};
#[cfg(unix)]
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// A place to be reached at, open until it is dropped.
#[derive(Debug)]
pub struct Listener {
    pub(crate) place: Place,
    pub(crate) shared: Arc<Shared>,
}

/// Why nothing can be reached there.
#[derive(Debug, thiserror::Error)]
pub enum ListenError {
    /// Nothing listens at such an address.
    #[error("{address} is no place to listen at; use tcp://HOST:PORT or unix:PATH")]
    Scheme {
        /// The address.
        address: String,
    },
    /// The system refused.
    #[error("cannot listen at {address}: {why}")]
    System {
        /// The address.
        address: String,
        /// What the system said.
        why: io::Error,
    },
}

#[derive(Debug)]
pub(crate) enum Place {
    Tcp(TcpListener),
    #[cfg(unix)]
    Unix(UnixListener, PathBuf),
    #[cfg(unix)]
    Pty(Pty),
    Stdio,
}

/// Ends a server from outside. Clones stop the same one.
#[derive(Clone, Debug)]
pub struct Stop {
    shared: Arc<Shared>,
    wake: Wake,
}

/// How to make the server look up.
#[derive(Clone, Debug)]
enum Wake {
    Tcp(SocketAddr),
    #[cfg(unix)]
    Unix(PathBuf),
    Nothing,
}

/// What a server and its [`Stop`] both know.
#[derive(Debug, Default)]
pub(crate) struct Shared(Mutex<Open>);

#[derive(Debug, Default)]
pub(crate) struct Open {
    pub(crate) stopped: bool,
    /// Connections, each in a slot of its own.
    pub(crate) connections: Vec<Option<Socket>>,
}

impl Shared {
    pub(crate) fn lock(&self) -> MutexGuard<'_, Open> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Listener {
    /// Opens an address for listening. Port 0 lets the system choose: [`Listener::address`] says what became of it. A
    /// socket file left by a server that is gone is replaced.
    ///
    /// # Errors
    /// [`ListenError`].
    pub fn bind(address: &Address) -> Result<Listener, ListenError> {
        let system = |why| ListenError::System { address: address.to_string(), why };
        let place = match address {
            Address::Tcp { host, port, .. } => {
                let places: Vec<_> = (host.as_str(), *port).to_socket_addrs().map_err(system)?.collect();
                TcpListener::bind(places.as_slice()).map(Place::Tcp)
            }
            #[cfg(unix)]
            Address::Unix { path, .. } => {
                remove_left_over(path);
                UnixListener::bind(path).map(|listener| Place::Unix(listener, path.clone()))
            }
            _ => return Err(ListenError::Scheme { address: address.to_string() }),
        };
        Ok(Listener { place: place.map_err(system)?, shared: Arc::default() })
    }

    /// Standard input and output: for a program that is started with `exec:`. It serves one connection.
    pub fn stdio() -> Listener {
        Listener { place: Place::Stdio, shared: Arc::default() }
    }

    /// A pseudo-terminal, reached as a serial line. It serves one harness after the other.
    ///
    /// # Errors
    /// What the system says.
    #[cfg(unix)]
    pub fn pty() -> io::Result<Listener> {
        Ok(Listener { place: Place::Pty(Pty::open()?), shared: Arc::default() })
    }

    /// The address a harness can connect to, with the port really used.
    ///
    /// # Errors
    /// What the system says.
    pub fn address(&self) -> io::Result<Address> {
        match &self.place {
            Place::Tcp(listener) => {
                let bound = listener.local_addr()?;
                Ok(Address::Tcp { host: bound.ip().to_string(), port: bound.port(), timeout: None })
            }
            #[cfg(unix)]
            Place::Unix(_, path) => Ok(Address::Unix { path: path.clone(), timeout: None }),
            #[cfg(unix)]
            Place::Pty(pty) => Ok(Address::Serial { path: pty.path().to_owned(), options: SerialOptions::default() }),
            Place::Stdio => Err(io::Error::new(io::ErrorKind::Unsupported, "standard input has no address")),
        }
    }

    /// What stops the server of this listener. Standard input cannot be stopped; it ends with its other end.
    ///
    /// # Errors
    /// What the system says.
    pub fn stop(&self) -> io::Result<Stop> {
        let wake = match &self.place {
            Place::Tcp(listener) => Wake::Tcp(reachable(listener.local_addr()?)),
            #[cfg(unix)]
            Place::Unix(_, path) => Wake::Unix(path.clone()),
            // It looks up by itself.
            #[cfg(unix)]
            Place::Pty(_) => Wake::Nothing,
            Place::Stdio => Wake::Nothing,
        };
        Ok(Stop { shared: Arc::clone(&self.shared), wake })
    }
}

impl Drop for Listener {
    fn drop(&mut self) {
        #[cfg(unix)]
        if let Place::Unix(_, path) = &self.place {
            let _ = std::fs::remove_file(path);
        }
    }
}

impl Stop {
    /// Ends all connections and lets [`serve`](crate::serve()) return. To stop what has stopped is no fault.
    pub fn stop(&self) {
        let mut open = self.shared.lock();
        open.stopped = true;
        open.connections.iter().flatten().for_each(Socket::shutdown);
        drop(open);
        // The server waits for a connection: it gets one.
        match &self.wake {
            Wake::Tcp(place) => drop(TcpStream::connect(place)),
            #[cfg(unix)]
            Wake::Unix(path) => drop(UnixStream::connect(path)),
            Wake::Nothing => {}
        }
    }
}

/// An address to connect to when listening at this one: "any" is none.
fn reachable(bound: SocketAddr) -> SocketAddr {
    let ip = match bound.ip() {
        IpAddr::V4(ip) if ip.is_unspecified() => Ipv4Addr::LOCALHOST.into(),
        IpAddr::V6(ip) if ip.is_unspecified() => Ipv6Addr::LOCALHOST.into(),
        ip => ip,
    };
    SocketAddr::new(ip, bound.port())
}

/// Removes a socket that nobody listens at, and nothing else.
#[cfg(unix)]
fn remove_left_over(path: &Path) {
    let is_socket = std::fs::symlink_metadata(path).is_ok_and(|data| data.file_type().is_socket());
    let refused = |error: io::Error| error.kind() == io::ErrorKind::ConnectionRefused;
    if is_socket && UnixStream::connect(path).is_err_and(refused) {
        let _ = std::fs::remove_file(path);
    }
}
