//! The passes over traces, inlined into the training loop, which is compiled for each instruction set. They work in whole
//! blocks, because the number of traces is hard to predict and the number of blocks is not.

#![expect(clippy::inline_always, reason = "code compiled per instruction set must be inlined into its dispatcher")]

/// The number of traces per iteration.
pub(super) const BLOCK: usize = 16;

/// A vector register of the widest instruction set. A wider array would not stay in one.
const LANES: usize = 4;

type Vector = [f64; LANES];

/// w ← w + `step` z.
#[inline(always)]
pub(super) fn apply(values: &mut [f64], traces: &[f64], step: f64) {
    for (values, traces) in values.as_chunks_mut::<BLOCK>().0.iter_mut().zip(traces.as_chunks::<BLOCK>().0) {
        for (values, traces) in values.as_chunks_mut().0.iter_mut().zip(traces.as_chunks().0) {
            add(values, *traces, step);
        }
    }
}

/// z ← γλ z, where `factor` is γλ.
#[inline(always)]
pub(super) fn decay(traces: &mut [f64], factor: f64) {
    traces.as_chunks_mut::<BLOCK>().0.as_flattened_mut().iter_mut().for_each(|trace| *trace *= factor);
}

/// w ← w + `step` z, then z ← γλ z, where `factor` is γλ.
#[inline(always)]
pub(super) fn apply_and_decay(values: &mut [f64], traces: &mut [f64], step: f64, factor: f64) {
    for (values, traces) in values.as_chunks_mut::<BLOCK>().0.iter_mut().zip(traces.as_chunks_mut::<BLOCK>().0) {
        for (values, traces) in values.as_chunks_mut().0.iter_mut().zip(traces.as_chunks_mut().0) {
            let before = *traces;
            add(values, before, step);
            *traces = before.map(|trace| trace * factor);
        }
    }
}

/// Reads all lanes before it writes one: the compiler does not know that the values and the traces are apart, and would
/// compute lane by lane.
#[inline(always)]
fn add(values: &mut Vector, traces: Vector, step: f64) {
    let old = *values;
    *values = std::array::from_fn(|lane| old[lane] + step * traces[lane]);
}

/// [`decay`], which writes to `fallen` in which blocks a trace has fallen to the cutoff. Returns whether one has.
#[inline(always)]
pub(super) fn decay_and_find(traces: &mut [f64], factor: f64, cutoff: f64, fallen: &mut [bool]) -> bool {
    let mut any = false;
    for (traces, fallen) in traces.as_chunks_mut::<BLOCK>().0.iter_mut().zip(fallen) {
        let mut smallest = [f64::INFINITY; LANES];
        for traces in traces.as_chunks_mut().0 {
            *traces = decay_vector(*traces, factor, &mut smallest);
        }
        *fallen = any_fallen(&smallest, cutoff);
        any |= *fallen;
    }
    any
}

/// [`apply`], then [`decay_and_find`].
#[inline(always)]
pub(super) fn apply_decay_and_find(
    values: &mut [f64],
    traces: &mut [f64],
    step: f64,
    factor: f64,
    cutoff: f64,
    fallen: &mut [bool],
) -> bool {
    let mut any = false;
    let blocks = values.as_chunks_mut::<BLOCK>().0.iter_mut().zip(traces.as_chunks_mut::<BLOCK>().0);
    for ((values, traces), fallen) in blocks.zip(fallen) {
        let mut smallest = [f64::INFINITY; LANES];
        for (values, traces) in values.as_chunks_mut().0.iter_mut().zip(traces.as_chunks_mut().0) {
            let before = *traces;
            add(values, before, step);
            *traces = decay_vector(before, factor, &mut smallest);
        }
        *fallen = any_fallen(&smallest, cutoff);
        any |= *fallen;
    }
    any
}

/// Decays some traces, and keeps in `smallest` the smallest magnitude in each lane.
#[inline(always)]
fn decay_vector(traces: Vector, factor: f64, smallest: &mut Vector) -> Vector {
    let traces = traces.map(|trace| trace * factor);
    for (trace, smallest) in traces.iter().zip(smallest) {
        // One instruction, unlike `f64::min`. NaN, the trace of a place in use by no weight, is never the smallest.
        *smallest = if trace.abs() < *smallest { trace.abs() } else { *smallest };
    }
    traces
}

/// Whether one of some magnitudes has fallen to the cutoff.
#[inline(always)]
fn any_fallen(smallest: &Vector, cutoff: f64) -> bool {
    // Numbers as wide as the magnitudes, so that the lanes are compared at once.
    smallest.map(|magnitude| if magnitude <= cutoff { u64::MAX } else { 0 }) != [0; LANES]
}

/// The places of a block where a trace is at or below the cutoff, one bit each.
#[inline(always)]
pub(super) fn fallen_places(traces: &[f64; BLOCK], cutoff: f64) -> u64 {
    let mut lanes = [0; LANES];
    for (index, traces) in traces.as_chunks::<LANES>().0.iter().enumerate() {
        for (trace, lane) in traces.iter().zip(&mut lanes) {
            *lane |= if trace.abs() <= cutoff { 1 << (LANES * index) } else { 0 };
        }
    }
    lanes.iter().enumerate().fold(0, |places, (lane, bits)| places | bits << lane)
}
