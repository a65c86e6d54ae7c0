//! Eligibility traces, kept only where they are alive: a step costs as many operations as there are traces, however large
//! the table.

use std::hint::select_unpredictable;

use super::{Rate, StepSize};
use crate::table::Table;

/// What a visit does to the traces of its rows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Trace {
    /// It adds 1 (Sutton & Barto, section 12.7).
    Accumulating,
    /// It sets them to 1 (Singh & Sutton, 1996).
    Replacing,
    /// It sets them to 1, and those of the actions not taken there to 0 (the same paper).
    Clearing,
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Alive {
    weight: u32,
    trace: f64,
}

/// So many traces are corrected without asking whether they are the last.
const BLOCK: usize = 16;

/// z, one trace a weight. A trace that falls to the cutoff or below is dropped.
#[derive(Clone, Debug, PartialEq)]
pub struct Traces {
    /// Those alive are the first `count`.
    alive: Vec<Alive>,
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
    pub fn get(&self, weight: usize) -> f64 {
        match self.places[weight] {
            0 => 0.0,
            place => self.alive[place as usize - 1].trace,
        }
    }

    /// Changes the trace of a weight, which becomes alive.
    #[inline]
    pub fn change(&mut self, weight: usize, change: impl FnOnce(f64) -> f64) {
        if self.count == self.alive.len() {
            self.alive.push(Alive::default());
        }
        // Without a branch: whether a trace is alive already is hard to foresee.
        let place = (self.places[weight] as usize).checked_sub(1);
        let new = place.is_none();
        let place = place.unwrap_or(self.count);
        let trace = self.alive[place].trace;
        let trace = change(select_unpredictable(new, 0.0, trace));
        self.alive[place] = Alive { weight: weight as u32, trace };
        self.places[weight] = place as u32 + 1;
        self.count += usize::from(new);
    }

    /// A visit of a pair: its own traces grow, and others may end.
    #[inline]
    pub fn visit<const N: usize>(&mut self, kind: Trace, table: &Table<N>, rows: &[u32], action: usize) {
        for &row in rows {
            let weight = table.weight(row, action);
            match kind {
                Trace::Accumulating => self.change(weight, |trace| trace + 1.0),
                Trace::Replacing => self.change(weight, |_| 1.0),
                Trace::Clearing => {
                    self.change(weight, |_| 1.0);
                    for other in (0..table.actions()).filter(|&other| other != action) {
                        self.end(table.weight(row, other));
                    }
                }
            }
        }
    }

    fn end(&mut self, weight: usize) {
        if let Some(place) = (self.places[weight] as usize).checked_sub(1) {
            self.remove(place);
        }
    }

    #[cold]
    fn remove(&mut self, place: usize) {
        self.places[self.alive[place].weight as usize] = 0;
        self.count -= 1;
        if place < self.count {
            self.alive[place] = self.alive[self.count];
            self.places[self.alive[place].weight as usize] = place as u32 + 1;
        }
    }

    /// w ← w + α δ z.
    #[inline]
    pub fn correct<const N: usize>(&self, table: &mut Table<N>, rate: &Rate, error: f64) {
        if let Some(step) = rate.shared() {
            let step = step * error;
            for &Alive { weight, trace } in &self.alive[..self.count] {
                *table.weight_mut(weight as usize) += step * trace;
            }
        } else {
            for &Alive { weight, trace } in &self.alive[..self.count] {
                *table.weight_mut(weight as usize) += rate.at(weight as usize) * error * trace;
            }
        }
    }

    /// z ← γλ z.
    #[inline]
    pub fn decay(&mut self, factor: f64) {
        let (cutoff, mut ends) = (self.cutoff, false);
        for Alive { trace, .. } in &mut self.alive[..self.count] {
            *trace *= factor;
            ends |= trace.abs() <= cutoff;
        }
        if ends {
            self.forget();
        }
    }

    /// w ← w + α δ z and z ← γλ z in one pass.
    #[inline]
    pub fn correct_and_decay<const N: usize>(&mut self, table: &mut Table<N>, rate: &Rate, error: f64, factor: f64) {
        let Some(step) = rate.shared() else {
            self.correct(table, rate, error);
            self.decay(factor);
            return;
        };
        let (step, cutoff, mut ends) = (step * error, self.cutoff, false);
        let values = table.values_mut();
        let mut pass = |some: &mut [Alive]| {
            for Alive { weight, trace } in some {
                values[*weight as usize] += step * *trace;
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
            self.forget();
        }
    }

    /// Drops the traces at the cutoff or below.
    fn forget(&mut self) {
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
            self.places[alive.weight as usize] = 0;
        }
        self.count = 0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::learners::Schedule;

    fn visited(kind: Trace, actions: &[usize]) -> [f64; 2] {
        let table = Table::<2>::new(vec![0.0; 2], 2);
        let mut traces = Traces::new(2, 0.0);
        for &action in actions {
            traces.decay(0.5);
            traces.visit(kind, &table, &[0], action);
        }
        [traces.get(0), traces.get(1)]
    }

    #[test]
    fn each_kind_marks_a_visit_in_its_way() {
        assert_eq!(visited(Trace::Accumulating, &[0, 1, 1]), [0.25, 1.5]);
        assert_eq!(visited(Trace::Replacing, &[0, 1, 1]), [0.25, 1.0]);
        assert_eq!(visited(Trace::Clearing, &[0, 1, 1]), [0.0, 1.0]);
    }

    #[test]
    fn one_pass_does_what_two_do() {
        let mut tables = [Table::<2>::new(vec![1.0, 2.0, 3.0, 4.0], 2), Table::new(vec![1.0, 2.0, 3.0, 4.0], 2)];
        let mut traces = Traces::new(4, 0.25);
        (0..4).for_each(|weight| traces.change(weight, |_| 0.3 * (1 + weight) as f64));
        let (rate, mut once) = (Rate::scheduled(Schedule::constant(0.1), 2), traces.clone());
        traces.correct(&mut tables[0], &rate, -7.0);
        traces.decay(0.5);
        once.correct_and_decay(&mut tables[1], &rate, -7.0, 0.5);
        assert_eq!((&tables[0], traces), (&tables[1], once.clone()));
        assert_eq!(once.len(), 3);
    }

    #[test]
    fn a_trace_at_the_cutoff_is_dropped_and_the_others_keep_their_places() {
        let mut traces = Traces::new(4, 0.25);
        for weight in 0..4 {
            traces.change(weight, |_| if weight % 2 == 0 { 0.5 } else { 1.0 });
        }
        traces.decay(0.5);
        assert_eq!(traces.len(), 2);
        assert_eq!([0, 1, 2, 3].map(|weight| traces.get(weight)), [0.0, 0.5, 0.0, 0.5]);
        traces.clear();
        assert!(traces.is_empty() && traces.get(1) == 0.0);
    }
}
