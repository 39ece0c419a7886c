//! Asks the driver of a serial port to hand over octets at once.

use serialport::TTYPort;
use std::ffi::{c_int, c_ulong};
use std::os::fd::AsRawFd;

/// `ASYNC_LOW_LATENCY` of `linux/tty_flags.h`.
const LOW_LATENCY: c_int = 1 << 13;

/// The beginning of `struct serial_struct` of `linux/serial.h`, with room for more than all of it.
#[repr(C)]
#[derive(Default)]
struct Settings {
    kind: c_int,
    line: c_int,
    port: c_int,
    irq: c_int,
    flags: c_int,
    rest: [c_ulong; 16],
}

/// Best effort: drivers that collect octets, as those of many USB adapters do for 16 ms, stop doing so; those without
/// such a setting, and pseudo-terminals, refuse, and that is no fault.
pub(super) fn ask(port: &TTYPort) {
    let mut settings = Settings::default();
    #[expect(unsafe_code, reason = "the settings of a driver are reached by ioctl alone")]
    // SAFETY: the descriptor is open as long as `port` is borrowed, and `settings` is larger than the structure that
    // the first call fills and the second reads.
    unsafe {
        if libc::ioctl(port.as_raw_fd(), libc::TIOCGSERIAL, &raw mut settings) == 0 {
            settings.flags |= LOW_LATENCY;
            let _ = libc::ioctl(port.as_raw_fd(), libc::TIOCSSERIAL, &raw const settings);
        }
    }
}
