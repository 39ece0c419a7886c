//! What a failure looks like: a device with a deliberate fault. `cargo run -p fsct-conformance --example faulty -- FSD-0201`

use fsct_reference::{FsDevice, Mutant, Options};

fn faulty() -> FsDevice {
    FsDevice::new(Options { mutant: Some(Mutant::WrongSeed), ..Options::default() })
}

fsct_conformance::conformance! { device = faulty, edition = "iec2022", suites = ["device-counter", "master-recovery"] }
