//! The layouts against those the C compiler gives the header.

use super::*;
use std::mem::{offset_of, size_of};

/// The structs by their names in Rust and in C, with all members. `this` is called `self` in C.
macro_rules! layout {
    ($($rust:ident $c:literal { $($field:ident),* })*) => {
        fn ours() -> String {
            let mut text = String::new();
            $(
                text += &format!("{} {}\n", $c, size_of::<$rust>());
                $(text += &format!("{}.{} {}\n", $c, stringify!($field), offset_of!($rust, $field));)*
            )*
            text
        }

        /// A C program that prints the same.
        const PROGRAM: &str = concat!(
            "#include \"fsct_dut.h\"\n#include <stdio.h>\nint main(void) {\n",
            $(
                "printf(\"", $c, " %u\\n\", (unsigned)sizeof(struct ", $c, "));\n",
                $(
                    "printf(\"", $c, ".", stringify!($field), " %u\\n\", (unsigned)offsetof(struct ", $c, ", ",
                    stringify!($field), "));\n",
                )*
            )*
            "printf(\"FSCT_ABI %u\\n\", FSCT_ABI);\nreturn 0; }\n"
        );
    };
}

layout! {
    Offer "fsct_offer" { edition, mode, pd_out_min, pd_out_max, pd_in_min, pd_in_max }
    Description "fsct_description" {
        role, ports, pcos, clock, resolution_ns, uncertainty_ns, vendor, product, version, offers, offer_count
    }
    Identity "fsct_identity" { revision_id, com, min_cycle_time, pd_in, pd_out, vendor_id, device_id }
    Stimulus "fsct_stimulus" {
        kind, port, number, flag, subindex, index, code, client_id, block_id, length, octets, ns, variant, identity
    }
    Observation "fsct_observation" {
        kind, port, number, flag, subindex, index, code, client_id, block_id, block_length, length, octets, ns
    }
    Sink "fsct_sink" { see, now }
    Dut "fsct_dut" { abi, this, hello, apply }
}

#[test]
fn every_struct_is_laid_out_as_the_c_compiler_lays_it_out() {
    let Some(theirs) = fsct_c::output_of(&PROGRAM.replace("this", "self")) else { return };
    assert_eq!(format!("{}FSCT_ABI {VERSION}\n", ours()), theirs.replace("self", "this"));
}
