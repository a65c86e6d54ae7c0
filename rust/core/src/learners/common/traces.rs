//! Eligibility traces, kept only where they are alive: a step costs as many operations as there are traces, however large
//! the table.

use std::hint::select_unpredictable;

use crate::q_table::QTable;
use crate::schedules::{LearningRate, StepSize};

/// What a visit does to the traces of its rows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TraceKind {
    /// It adds 1 (Sutton & Barto, section 12.7).
    Accumulating,
    /// It sets them to 1 (Singh & Sutton, 1996).
    Replacing,
    /// It sets them to 1, and those of the actions not taken there to 0 (the same paper).
    Clearing,
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct ActiveTrace {
    weight_index: u32,
    trace: f64,
}

/// So many traces are corrected without asking whether they are the last.
const BLOCK: usize = 16;

/// z, one trace a weight. A trace that falls to the cutoff or below is dropped.
#[derive(Clone, Debug, PartialEq)]
pub struct Traces {
    /// Those alive are the first `count`.
    alive: Vec<ActiveTrace>,
    count: usize,
    /// Where in `alive` a weight's trace is, counted from 1; 0 where it has none.
    places: Vec<u32>,
    cutoff: f64,
}

impl Traces {
    /// No trace alive, of so many weights.
    pub fn new(weights: usize, cutoff: f64) -> Self {
        Self { alive: Vec::new(), count: 0, places: vec![0; weights], cutoff }
    }

    /// How many are alive.
    pub fn len(&self) -> usize {
        self.count
    }

    /// Whether none is alive.
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// The trace of a weight.
    #[inline]
    pub fn get(&self, weight_index: usize) -> f64 {
        match self.places[weight_index] {
            0 => 0.0,
            place => self.alive[place as usize - 1].trace,
        }
    }

    /// Changes the trace of a weight, which becomes alive.
    #[inline]
    pub fn update(&mut self, weight_index: usize, change: impl FnOnce(f64) -> f64) {
        if self.count == self.alive.len() {
            self.alive.push(ActiveTrace::default());
        }
        // Without a branch: whether a trace is alive already is hard to foresee.
        let place = (self.places[weight_index] as usize).checked_sub(1);
        let new = place.is_none();
        let place = place.unwrap_or(self.count);
        let trace = self.alive[place].trace;
        let trace = change(select_unpredictable(new, 0.0, trace));
        self.alive[place] = ActiveTrace { weight_index: weight_index as u32, trace };
        self.places[weight_index] = place as u32 + 1;
        self.count += usize::from(new);
    }

    /// A visit of a pair: its own traces grow, and others may end.
    #[inline]
    pub fn visit<const N: usize>(&mut self, kind: TraceKind, table: &QTable<N>, rows: &[u32], action: usize) {
        for &row in rows {
            let weight_index = table.weight_index(row, action);
            match kind {
                TraceKind::Accumulating => self.update(weight_index, |trace| trace + 1.0),
                TraceKind::Replacing => self.update(weight_index, |_| 1.0),
                TraceKind::Clearing => {
                    self.update(weight_index, |_| 1.0);
                    for other in (0..table.num_actions()).filter(|&other| other != action) {
                        self.remove_weight(table.weight_index(row, other));
                    }
                }
            }
        }
    }

    fn remove_weight(&mut self, weight_index: usize) {
        if let Some(place) = (self.places[weight_index] as usize).checked_sub(1) {
            self.remove(place);
        }
    }

    #[cold]
    fn remove(&mut self, place: usize) {
        self.places[self.alive[place].weight_index as usize] = 0;
        self.count -= 1;
        if place < self.count {
            self.alive[place] = self.alive[self.count];
            self.places[self.alive[place].weight_index as usize] = place as u32 + 1;
        }
    }

    /// w ← w + α δ z.
    #[inline]
    pub fn apply_td_error<const N: usize>(&self, table: &mut QTable<N>, rate: &LearningRate, error: f64) {
        if let Some(step) = rate.uniform() {
            let step = step * error;
            for &ActiveTrace { weight_index, trace } in &self.alive[..self.count] {
                *table.weight_mut(weight_index as usize) += step * trace;
            }
        } else {
            for &ActiveTrace { weight_index, trace } in &self.alive[..self.count] {
                *table.weight_mut(weight_index as usize) += rate.at(weight_index as usize) * error * trace;
            }
        }
    }

    /// z ← γλ z.
    #[inline]
    pub fn decay(&mut self, factor: f64) {
        let (cutoff, mut ends) = (self.cutoff, false);
        for ActiveTrace { trace, .. } in &mut self.alive[..self.count] {
            *trace *= factor;
            ends |= trace.abs() <= cutoff;
        }
        if ends {
            self.prune();
        }
    }

    /// w ← w + α δ z and z ← γλ z in one pass.
    #[inline]
    pub fn apply_td_error_and_decay<const N: usize>(
        &mut self,
        table: &mut QTable<N>,
        rate: &LearningRate,
        error: f64,
        factor: f64,
    ) {
        let Some(step) = rate.uniform() else {
            self.apply_td_error(table, rate, error);
            self.decay(factor);
            return;
        };
        let (step, cutoff, mut ends) = (step * error, self.cutoff, false);
        let values = table.values_mut();
        let mut pass = |some: &mut [ActiveTrace]| {
            for ActiveTrace { weight_index, trace } in some {
                values[*weight_index as usize] += step * *trace;
                *trace *= factor;
                ends |= trace.abs() <= cutoff;
            }
        };
        // Their number is hard to foresee, that of whole blocks is not. With the odd ones first, the processor soon knows
        // where the loop ends, and goes on to the next step meanwhile.
        let (odd, blocks) = self.alive[..self.count].as_rchunks_mut::<BLOCK>();
        pass(odd);
        for block in blocks {
            pass(block);
        }
        if ends {
            self.prune();
        }
    }

    /// Drops the traces at the cutoff or below.
    fn prune(&mut self) {
        let mut place = 0;
        while place < self.count {
            if self.alive[place].trace.abs() <= self.cutoff {
                self.remove(place);
            } else {
                place += 1;
            }
        }
    }

    /// z ← 0.
    pub fn clear(&mut self) {
        for alive in &self.alive[..self.count] {
            self.places[alive.weight_index as usize] = 0;
        }
        self.count = 0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::schedules::Schedule;

    fn visited(kind: TraceKind, actions: &[usize]) -> [f64; 2] {
        let table = QTable::<2>::new(vec![0.0; 2], 2);
        let mut traces = Traces::new(2, 0.0);
        for &action in actions {
            traces.decay(0.5);
            traces.visit(kind, &table, &[0], action);
        }
        [traces.get(0), traces.get(1)]
    }

    #[test]
    fn each_kind_marks_a_visit_in_its_way() {
        assert_eq!(visited(TraceKind::Accumulating, &[0, 1, 1]), [0.25, 1.5]);
        assert_eq!(visited(TraceKind::Replacing, &[0, 1, 1]), [0.25, 1.0]);
        assert_eq!(visited(TraceKind::Clearing, &[0, 1, 1]), [0.0, 1.0]);
    }

    #[test]
    fn one_pass_does_what_two_do() {
        let mut tables = [QTable::<2>::new(vec![1.0, 2.0, 3.0, 4.0], 2), QTable::new(vec![1.0, 2.0, 3.0, 4.0], 2)];
        let mut traces = Traces::new(4, 0.25);
        (0..4).for_each(|weight_index| traces.update(weight_index, |_| 0.3 * (1 + weight_index) as f64));
        let (rate, mut once) = (LearningRate::scheduled(Schedule::constant(0.1), 2), traces.clone());
        traces.apply_td_error(&mut tables[0], &rate, -7.0);
        traces.decay(0.5);
        once.apply_td_error_and_decay(&mut tables[1], &rate, -7.0, 0.5);
        assert_eq!((&tables[0], traces), (&tables[1], once.clone()));
        assert_eq!(once.len(), 3);
    }

    #[test]
    fn a_trace_at_the_cutoff_is_dropped_and_the_others_keep_their_places() {
        let mut traces = Traces::new(4, 0.25);
        for weight_index in 0..4 {
            traces.update(weight_index, |_| if weight_index % 2 == 0 { 0.5 } else { 1.0 });
        }
        traces.decay(0.5);
        assert_eq!(traces.len(), 2);
        assert_eq!([0, 1, 2, 3].map(|weight_index| traces.get(weight_index)), [0.0, 0.5, 0.0, 0.5]);
        traces.clear();
        assert!(traces.is_empty() && traces.get(1) == 0.0);
    }
}
