//! The contract with a device under test and every way to reach one.
//!
//! This crate moves octets. It knows frames, processes, sockets and serial lines; it does not know what an SPDU is.
//!
//! ```no_run
//! use fsct_adapters::{Address, Dut, connect};
//!
//! let address: Address = "tcp://127.0.0.1:5061?timeout=500ms".parse()?;
//! let description = connect(&address)?.hello()?;
//! println!("{:?}", description.product);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod address;
mod clock_proof;
mod connect;
mod contract;
mod error;
pub mod frame;
mod latency;
mod library;
mod listener;
pub mod message;
mod process;
mod recorder;
mod serial;
mod serve;
mod socket;
mod stream;

pub use address::{Address, AddressError};
pub use clock_proof::{ClockProof, Finding, Monotonic, PAUSE_NS, Trip, Watch};
pub use connect::{CONNECT_TIMEOUT, connect, connect_within};
pub use contract::{
    Clock, ClockKind, Description, Dut, Identity, Line, MAX_BATCH, MAX_RECORD, Mode, Observation, Octets, Offer, Pco,
    Response, Role, Seen, Service, SmiRequest, SmiResult, SmiService, Source, Stimulus, Variant, smi,
};
pub use error::{DutError, Fault};
pub use fsct_protocol::{Edition, ProtMode};
pub use latency::{Latency, MADE_UP};
pub use library::{Library, frames_apart};
pub use listener::{ListenError, Listener, Stop};
pub use recorder::{Answer, Entry, Happened, Keep, Recorder, Recording};
pub use serial::{Flow, Reset, SerialOptions, WAIT};
pub use serve::{MAX_CONNECTIONS, serve, serve_stream};
pub use stream::{FLOOD_PER_STIMULUS, FLOOD_SLACK, Peer, REPLY_TIMEOUT, StreamDut};
