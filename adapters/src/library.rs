//! A DUT in a shared library, reached through the C ABI of `adapters/c/fsct_dut.h`.
//!
//! What a library does to its process it does to everything in it, so a library is only ever loaded by a process made for
//! that: a child of the one that judges, which serves it on standard input and output. A crash of the library is then an
//! end of the child, told with its signal, and an endless loop a time-out.

#![expect(unsafe_code, reason = "the boundary to C: each block says what it relies on")]

mod abi;
mod convert;

use crate::{Description, Dut, DutError, FLOOD_PER_STIMULUS, FLOOD_SLACK, Observation, Stimulus};
use std::ffi::c_void;
#[cfg(unix)]
use std::fs::File;
use std::io;
#[cfg(unix)]
use std::os::fd::{AsFd, BorrowedFd};
use std::path::Path;
use std::ptr;

/// Name of the function that a library exports.
const ENTRY: &str = "fsct_dut";

/// A loaded library. It stays loaded until the process ends: nobody knows whether it can be unloaded.
pub struct Library {
    dut: abi::Dut,
    host: Box<Host>,
}

/// What the library is handed as its sink, and what it has put there.
#[repr(C)]
struct Host {
    /// First, so that a pointer to it is a pointer to the whole.
    sink: abi::Sink,
    /// Observations of the stimulus being carried out.
    seen: Vec<Observation>,
    /// Position of that stimulus.
    stimulus: u16,
    /// Observations that may still come in this request.
    room: usize,
    /// What was wrong first.
    fault: Option<DutError>,
}

// SAFETY: the library is called from the one thread that holds the `Library`, one call at a time; `&mut` sees to that.
unsafe impl Send for Library {}

impl Library {
    /// Loads a library and asks it for its DUT. Not to be called in a process that has anything to lose.
    ///
    /// # Errors
    /// [`DutError::Contract`]: what the system says against the file, or what the library lacks.
    pub fn load(path: &Path) -> Result<Library, DutError> {
        let file = path.display();
        let library = open(path).map_err(|error| broken(format!("{file} cannot be loaded: {}", whole(&error))))?;
        // SAFETY: the type is that of the header, and the version is looked at below before anything else is. A library
        // that exports another function by this name cannot be told from here.
        let entry = unsafe { library.get::<extern "C" fn() -> *const abi::Dut>(ENTRY) };
        let entry = *entry.map_err(|error| {
            broken(format!("{file} exports no function {ENTRY}, as fsct_dut.h asks ({})", whole(&error)))
        })?;
        std::mem::forget(library);
        let dut = entry();
        if dut.is_null() {
            return Err(broken(format!("{ENTRY}() of {file} returned a null pointer")));
        }
        // SAFETY: not null; a `struct fsct_dut` that lives as long as the library. Its first member is the version in all
        // versions.
        let version = unsafe { ptr::addr_of!((*dut).abi).read_unaligned() };
        if version != abi::VERSION {
            let ours = abi::VERSION;
            return Err(broken(format!(
                "{file} was made for version {version} of fsct_dut.h, this fsct has version {ours}"
            )));
        }
        // SAFETY: as above, and now known to be of this version.
        let dut = unsafe { dut.read_unaligned() };
        let sink = abi::Sink { see: Some(see), now: 0 };
        let host = Box::new(Host { sink, seen: Vec::new(), stimulus: 0, room: 0, fault: None });
        Ok(Library { dut, host })
    }

    fn carry_out(&mut self, stimulus: &Stimulus) -> Result<(), DutError> {
        let apply =
            self.dut.apply.ok_or_else(|| broken("apply of its struct fsct_dut is a null pointer".to_owned()))?;
        let mut octets = Vec::new();
        let raw = convert::stimulus(stimulus, &mut octets);
        let host: *mut Host = &mut *self.host;
        // SAFETY: the pointers hold for the call: `raw` with its octets on this stack frame, `host` in its box, which
        // nothing else touches meanwhile. The sink is the first member of `Host`.
        unsafe { apply(self.dut.this, &raw, host.cast::<abi::Sink>()) };
        self.host.fault.take().map_or(Ok(()), Err)
    }
}

impl Dut for Library {
    fn hello(&mut self) -> Result<Description, DutError> {
        let hello =
            self.dut.hello.ok_or_else(|| broken("hello of its struct fsct_dut is a null pointer".to_owned()))?;
        // SAFETY: the function is the library's own for this version of the header; `this` is handed back as it came.
        let raw = unsafe { hello(self.dut.this) };
        if raw.is_null() {
            return Err(broken("hello returned a null pointer".to_owned()));
        }
        // SAFETY: not null; a `struct fsct_description` that holds at least until the next call.
        let raw = unsafe { raw.read_unaligned() };
        // SAFETY: as the header says of the fields: texts end with 0, `offers` has `offer_count` entries.
        unsafe { convert::description(&raw) }.map_err(|error| broken(error.to_string()))
    }

    fn apply(&mut self, stimuli: &[Stimulus], observed: &mut Vec<Observation>) -> Result<(), DutError> {
        self.host.room = FLOOD_PER_STIMULUS * stimuli.len() + FLOOD_SLACK;
        for (position, stimulus) in stimuli.iter().enumerate() {
            self.host.stimulus = position as u16;
            let outcome = self.carry_out(stimulus);
            observed.append(&mut self.host.seen);
            outcome?;
        }
        Ok(())
    }
}

/// Takes an observation. What is wrong with one is told when the call of the library returns; what comes after that, or
/// beyond what any stimulus can cause, is dropped, so that a library cannot fill the memory.
unsafe extern "C" fn see(sink: *mut abi::Sink, raw: *const abi::Observation) {
    // SAFETY: the header says that the sink is handed back as it came, during `apply`: then it is the first member of a
    // `Host` that lives and that nobody else holds.
    let Some(host) = (unsafe { sink.cast::<Host>().as_mut() }) else { return };
    if host.fault.is_some() {
        return;
    }
    if host.room == 0 {
        host.fault = Some(broken("it saw more than any stimuli can cause".to_owned()));
        return;
    }
    host.room -= 1;
    if raw.is_null() {
        host.fault = Some(broken("an observation is a null pointer".to_owned()));
        return;
    }
    // SAFETY: not null; an observation of this version of the header that holds until this function returns, and its
    // `octets` have `length` octets.
    match unsafe { convert::seen(&raw.read_unaligned()) } {
        Ok((at, seen)) => host.seen.push(Observation { stimulus: host.stimulus, at, seen }),
        Err(error) => host.fault = Some(broken(error.to_string())),
    }
}

fn broken(what: String) -> DutError {
    DutError::Contract { what }
}

/// Opens a library with all it needs: what is missing shows now, not in the middle of a case.
fn open(path: &Path) -> Result<libloading::Library, libloading::Error> {
    #[cfg(unix)]
    {
        use libloading::os::unix;
        // SAFETY: loading runs code of the library; this process is made for that.
        unsafe { unix::Library::open(Some(path), unix::RTLD_NOW | unix::RTLD_LOCAL) }.map(Into::into)
    }
    #[cfg(not(unix))]
    // SAFETY: as above.
    unsafe {
        libloading::Library::new(path)
    }
}

/// What the loader says stands in the cause, not in the error itself.
fn whole(error: &libloading::Error) -> String {
    match std::error::Error::source(error) {
        Some(cause) => cause.to_string(),
        None => error.to_string(),
    }
}

/// A `void *` of the library's own.
type This = *mut c_void;

/// Keeps standard input and output for frames alone: what a library prints to standard output goes to standard error from
/// here on, and its standard input is at its end. To be called before anything is loaded.
///
/// # Errors
/// What the system says.
#[cfg(unix)]
pub fn frames_apart() -> io::Result<(File, File)> {
    let kept = |stream: BorrowedFd<'_>| stream.try_clone_to_owned().map(File::from);
    let frames = (kept(io::stdin().as_fd())?, kept(io::stdout().as_fd())?);
    rustix::stdio::dup2_stdin(File::open("/dev/null")?)?;
    rustix::stdio::dup2_stdout(io::stderr())?;
    Ok(frames)
}

/// Standard input and output; a library must not print there.
///
/// # Errors
/// None.
#[cfg(not(unix))]
pub fn frames_apart() -> io::Result<(io::Stdin, io::Stdout)> {
    Ok((io::stdin(), io::stdout()))
}
