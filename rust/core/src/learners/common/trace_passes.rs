//! The passes over traces, compiled for each instruction set. They work in whole blocks, because the number of traces is
//! hard to predict and the number of blocks is not.

#![expect(clippy::inline_always, reason = "code compiled per instruction set must be inlined into its dispatcher")]

/// The number of traces per iteration.
pub(super) const BLOCK: usize = 16;

/// A vector register of the widest instruction set. A wider array would not stay in one.
const LANES: usize = 4;

type Vector = [f64; LANES];

/// z ← γλ z, where `factor` is γλ. Returns whether a trace has fallen to the cutoff, and writes to `fallen` in which
/// blocks.
pub(super) struct DecayTraces<'a> {
    pub(super) traces: &'a mut [f64],
    pub(super) fallen: &'a mut [bool],
    pub(super) factor: f64,
    pub(super) cutoff: f64,
}

impl DecayTraces<'_> {
    /// Decays some traces. Bits of `fallen` are set in the lanes where one has fallen to the cutoff.
    #[inline(always)]
    fn decay(traces: &mut Vector, factor: f64, cutoff: f64, fallen: &mut [u64; LANES]) {
        *traces = traces.map(|trace| trace * factor);
        for (trace, fallen) in traces.iter().zip(fallen) {
            *fallen |= if trace.abs() <= cutoff { u64::MAX } else { 0 };
        }
    }
}

impl pulp::NullaryFnOnce for DecayTraces<'_> {
    type Output = bool;

    #[inline(always)]
    fn call(self) -> bool {
        let mut any = false;
        for (traces, fallen) in self.traces.as_chunks_mut::<BLOCK>().0.iter_mut().zip(self.fallen) {
            let mut lanes = [0; LANES];
            for traces in traces.as_chunks_mut().0 {
                Self::decay(traces, self.factor, self.cutoff, &mut lanes);
            }
            *fallen = lanes != [0; LANES];
            any |= *fallen;
        }
        any
    }
}

/// w ← w + `step` z, then [`DecayTraces`].
pub(super) struct ApplyAndDecayTraces<'a> {
    pub(super) values: &'a mut [f64],
    pub(super) step: f64,
    pub(super) decay: DecayTraces<'a>,
}

impl pulp::NullaryFnOnce for ApplyAndDecayTraces<'_> {
    type Output = bool;

    #[inline(always)]
    fn call(self) -> bool {
        let Self { values, step, decay: DecayTraces { traces, fallen, factor, cutoff } } = self;
        let mut any = false;
        let blocks = values.as_chunks_mut::<BLOCK>().0.iter_mut().zip(traces.as_chunks_mut::<BLOCK>().0);
        for ((values, traces), fallen) in blocks.zip(fallen) {
            let mut lanes = [0; LANES];
            for (values, traces) in values.as_chunks_mut::<LANES>().0.iter_mut().zip(traces.as_chunks_mut().0) {
                apply(values, traces, step);
                DecayTraces::decay(traces, factor, cutoff, &mut lanes);
            }
            *fallen = lanes != [0; LANES];
            any |= *fallen;
        }
        any
    }
}

/// Reads all lanes before it writes one: the compiler does not know that the values and the traces are apart, and would
/// compute lane by lane.
#[inline(always)]
fn apply(values: &mut Vector, traces: &Vector, step: f64) {
    let old = *values;
    *values = std::array::from_fn(|lane| old[lane] + step * traces[lane]);
}

/// w ← w + `step` z.
pub(super) struct ApplyTraces<'a> {
    pub(super) values: &'a mut [f64],
    pub(super) traces: &'a [f64],
    pub(super) step: f64,
}

impl pulp::NullaryFnOnce for ApplyTraces<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let vectors = self.values.as_chunks_mut::<LANES>().0.iter_mut().zip(self.traces.as_chunks().0);
        vectors.for_each(|(values, traces)| apply(values, traces, self.step));
    }
}

/// The instruction set that the passes run on.
#[derive(Clone, Copy, Debug)]
pub(super) struct InstructionSet(pulp::Arch);

impl InstructionSet {
    /// The widest one that this machine has.
    pub(super) fn detect() -> Self {
        Self(pulp::Arch::new())
    }

    /// Runs a pass.
    #[inline]
    pub(super) fn run<P: pulp::NullaryFnOnce>(self, pass: P) -> P::Output {
        self.0.dispatch(pass)
    }
}

/// All of them have the same results.
impl PartialEq for InstructionSet {
    fn eq(&self, _other: &Self) -> bool {
        true
    }
}
