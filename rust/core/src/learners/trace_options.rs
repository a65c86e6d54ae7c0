//! The options of eligibility traces.

use super::TraceKind;

/// The options of an algorithm whose eligibility traces are of a kind.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TraceOptions {
    /// What a visit does to a trace.
    pub kind: TraceKind,
    /// The trace decay λ.
    pub decay: f64,
    /// Traces at or below this are dropped.
    pub cutoff: f64,
}
