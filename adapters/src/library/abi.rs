//! The structs of `adapters/c/fsct_dut.h` as Rust sees them. A test compares every size and place with what the C compiler
//! makes of the header.

use super::This;
use std::ffi::c_char;

/// `FSCT_ABI`.
pub(super) const VERSION: u32 = 1;

/// `struct fsct_offer`.
#[repr(C)]
#[derive(Copy, Clone, Default)]
pub(super) struct Offer {
    pub edition: u8,
    pub mode: u8,
    pub pd_out_min: u8,
    pub pd_out_max: u8,
    pub pd_in_min: u8,
    pub pd_in_max: u8,
}

/// `struct fsct_description`.
#[repr(C)]
#[derive(Copy, Clone)]
pub(super) struct Description {
    pub role: u8,
    pub ports: u8,
    pub pcos: u8,
    pub clock: u8,
    pub resolution_ns: u64,
    pub uncertainty_ns: u64,
    pub vendor: *const c_char,
    pub product: *const c_char,
    pub version: *const c_char,
    pub offers: *const Offer,
    pub offer_count: usize,
}

/// `struct fsct_identity`.
#[repr(C)]
#[derive(Copy, Clone, Default)]
pub(super) struct Identity {
    pub revision_id: u8,
    pub com: u8,
    pub min_cycle_time: u8,
    pub pd_in: u8,
    pub pd_out: u8,
    pub vendor_id: u16,
    pub device_id: u32,
}

/// `struct fsct_stimulus`.
#[repr(C)]
#[derive(Copy, Clone)]
pub(super) struct Stimulus {
    pub kind: u8,
    pub port: u8,
    pub number: u8,
    pub flag: u8,
    pub subindex: u8,
    pub index: u16,
    pub code: u16,
    pub client_id: u16,
    pub block_id: u16,
    pub length: u16,
    pub octets: *const u8,
    pub ns: u64,
    pub variant: Offer,
    pub identity: Identity,
}

/// `struct fsct_observation`.
#[repr(C)]
#[derive(Copy, Clone)]
pub(super) struct Observation {
    pub kind: u8,
    pub port: u8,
    pub number: u8,
    pub flag: u8,
    pub subindex: u8,
    pub index: u16,
    pub code: u16,
    pub client_id: u16,
    pub block_id: u16,
    pub block_length: u16,
    pub length: u16,
    pub octets: *const u8,
    pub ns: u64,
}

/// `struct fsct_sink`.
#[repr(C)]
pub(super) struct Sink {
    pub see: Option<unsafe extern "C" fn(*mut Sink, *const Observation)>,
    pub now: u64,
}

/// `struct fsct_dut`.
#[repr(C)]
#[derive(Copy, Clone)]
pub(super) struct Dut {
    pub abi: u32,
    pub this: This,
    pub hello: Option<unsafe extern "C" fn(This) -> *const Description>,
    pub apply: Option<unsafe extern "C" fn(This, *const Stimulus, *mut Sink)>,
}

#[cfg(test)]
#[path = "layout.rs"]
mod layout;
