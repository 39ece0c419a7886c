//! The conformance cases of IO-Link Safety, one test each: `cargo test -p rust-device --test conformance`.

mod dut;

fsct_conformance::conformance! { device = dut::MyDevice::default, profile = "my-device.yaml" }
