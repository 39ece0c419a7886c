//! The conformance cases as tests of a vendor's own `cargo test`: one test a case, which cargo test and nextest list,
//! filter, run and report like any other.
//!
//! ```toml
//! [dev-dependencies]
//! fsct-conformance = "0.1"
//!
//! [[test]]
//! name = "conformance"
//! harness = false
//! ```
//!
//! and in `tests/conformance.rs` one call of [`conformance!`]. What a DUT has to implement is [`adapters::Dut`].

mod guard;
mod suite;
mod test;

pub use fsct_adapters as adapters;
pub use suite::Suite;
pub use test::{Outcome, Test};

/// Writes the `main` of a test target with `harness = false`.
///
/// ```no_run
/// # use fsct_reference::FsDevice as MyDevice;
/// fsct_conformance::conformance! { device = || MyDevice::new(Default::default()), seed = 7, strict = ["A19"] }
/// ```
///
/// The first key is `device` or `master`: a closure that makes a DUT. It is called once to learn what the DUT is and once for
/// each case, from several threads at once, so nothing is shared between cases and the closure is `Fn + Send + Sync`. Where
/// only one can exist, a board on a serial line, run with `--test-threads=1`. The other keys may be left out:
///
/// | key | value | without it |
/// |---|---|---|
/// | `profile` | file, relative to the `Cargo.toml` of the package; it becomes part of the test program | `reference-device`, `reference-master` |
/// | `suites` | names of suites or groups: `["scl-device"]` | all for the role |
/// | `edition` | `"v1.1"` or `"iec2022"` | those the DUT offers |
/// | `filter` | terms as for `fsct run --filter`, all have to match | no filter |
/// | `seed` | number that everything random derives from | 1 |
/// | `strict`, `tolerate` | ids of tolerances, `["A19"]`; `["all"]` strict is none at all | as the profile says |
///
/// A pass or a remark is ok; a remark is told on stderr. All else fails, with the clause, what was expected and observed, the
/// SPDUs decoded, and the line that runs this case alone. What does not apply is ignored, with the term that excluded it.
/// `fsct::profile`, `fsct::hello` and `fsct::plan` are tests that stand for all when no case can be run, and fail.
/// A DUT that panics fails the case it panics in.
#[macro_export]
macro_rules! conformance {
    (@with $suite:ident, profile, $value:expr) => {
        $suite.profile($value, include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/", $value)))
    };
    (@with $suite:ident, $key:ident, $value:expr) => {
        $suite.$key($value)
    };
    ($role:ident = $make:expr $(, $key:ident = $value:expr)* $(,)?) => {
        fn main() -> ::std::process::ExitCode {
            let suite = $crate::Suite::$role($make);
            let suite = suite.target(env!("CARGO_PKG_NAME"), env!("CARGO_CRATE_NAME"));
            $(let suite = $crate::conformance!(@with suite, $key, $value);)*
            suite.main()
        }

        // Exists only where libtest would run this target, and nothing else of it.
        #[test]
        fn harness_is_false() {
            panic!("this target needs `harness = false` in Cargo.toml; as it is, no conformance case runs");
        }
    };
}
