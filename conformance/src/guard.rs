//! A DUT that panics is a finding about the DUT, not the end of the tests.

use fsct_adapters::{Description, Dut, DutError, Observation, Stimulus};
use std::cell::Cell;
use std::panic::{AssertUnwindSafe, catch_unwind, set_hook, take_hook};

thread_local! {
    /// Where the last panic of this thread was.
    static PLACE: Cell<Option<String>> = const { Cell::new(None) };
}

/// From now on the place of a panic is part of what is told about it.
pub fn note_places() {
    let usual = take_hook();
    set_hook(Box::new(move |panic| {
        PLACE.set(panic.location().map(|place| format!(" ({}:{})", place.file(), place.line())));
        usual(panic);
    }));
}

/// A panic inside `call` as an error of the DUT.
pub fn guarded<T>(call: impl FnOnce() -> Result<T, DutError>) -> Result<T, DutError> {
    catch_unwind(AssertUnwindSafe(call)).unwrap_or_else(|panic| {
        let text = panic.downcast_ref::<&str>().map(|text| (*text).to_owned());
        let text = text.or_else(|| panic.downcast_ref::<String>().cloned()).unwrap_or_default();
        Err(DutError::Contract { what: format!("it panicked: {text}{}", PLACE.take().unwrap_or_default()) })
    })
}

/// A DUT whose panics are errors.
pub struct Guarded<D>(pub D);

impl<D: Dut> Dut for Guarded<D> {
    fn hello(&mut self) -> Result<Description, DutError> {
        guarded(|| self.0.hello())
    }

    fn apply(&mut self, stimuli: &[Stimulus], observed: &mut Vec<Observation>) -> Result<(), DutError> {
        guarded(|| self.0.apply(stimuli, observed))
    }
}
