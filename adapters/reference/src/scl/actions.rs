//! Which action of Table 40 a mutant leaves out. The machine asks at each action it shares between transitions, so that
//! each transition stays one list of actions.

use crate::Mutant;
use Action::{CommErrCount, DCommErr, DCount, DTimeout, DTimer, PdOut, SdCycles, SdSet, SetSdDc, TimeoutCount};
use Transition::{T22, T25, T28, T29, T30, T31};

/// A transition of Table 40 with actions.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub(super) enum Transition {
    T22,
    T25,
    T28,
    T29,
    T30,
    T31,
}

/// An action of Table 40, by the item it acts on.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub(super) enum Action {
    PdOut,
    SetSdDc,
    SdSet,
    DCommErr,
    CommErrCount,
    DTimeout,
    TimeoutCount,
    SdCycles,
    DCount,
    DTimer,
}

/// The one action this mutant leaves out, if it is of that kind.
pub(super) const fn left_out(mutant: Mutant) -> Option<(Transition, Action)> {
    Some(match mutant {
        Mutant::T22KeepsDTimer => (T22, DTimer),
        Mutant::T22KeepsSetSdDc => (T22, SetSdDc),
        Mutant::T22KeepsSdSet => (T22, SdSet),
        Mutant::T25KeepsPdout => (T25, PdOut),
        Mutant::T25KeepsSetSdDc => (T25, SetSdDc),
        Mutant::T25KeepsSdSet => (T25, SdSet),
        Mutant::T25KeepsDCommErr => (T25, DCommErr),
        Mutant::T25KeepsCommErrCount => (T25, CommErrCount),
        Mutant::T25KeepsDCount => (T25, DCount),
        Mutant::T25KeepsSdCycles => (T25, SdCycles),
        Mutant::T25KeepsDTimer => (T25, DTimer),
        Mutant::T28KeepsSdSet => (T28, SdSet),
        Mutant::T28KeepsDCount => (T28, DCount),
        Mutant::T28KeepsDTimer => (T28, DTimer),
        Mutant::T29KeepsDCommErr => (T29, DCommErr),
        Mutant::T29KeepsDCount => (T29, DCount),
        Mutant::T29KeepsSdCycles => (T29, SdCycles),
        Mutant::T29KeepsDTimer => (T29, DTimer),
        Mutant::T30KeepsDTimeout => (T30, DTimeout),
        Mutant::T30KeepsTimeoutCount => (T30, TimeoutCount),
        Mutant::T30KeepsSdCycles => (T30, SdCycles),
        Mutant::T31KeepsPdout => (T31, PdOut),
        Mutant::T31KeepsSetSdDc => (T31, SetSdDc),
        Mutant::T31KeepsSdSet => (T31, SdSet),
        Mutant::T31KeepsDTimeout => (T31, DTimeout),
        Mutant::T31KeepsTimeoutCount => (T31, TimeoutCount),
        Mutant::T31KeepsSdCycles => (T31, SdCycles),
        _ => return None,
    })
}
