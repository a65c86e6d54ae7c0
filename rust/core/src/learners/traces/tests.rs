use proptest::prelude::*;

use super::{TraceKind, Traces};
use crate::StopFlag;
use crate::checkpoint::{Checkpoint, Persist};
use crate::q_table::QTable;
use crate::schedules::{LearningRate, Schedule, StepSize};
use crate::simd::SimdLevel;

const ACTIONS: usize = 3;
const ROWS: usize = 40;

/// An operation of a learner on traces.
#[derive(Clone, Debug)]
enum Operation {
    Visit(TraceKind, Vec<u32>, usize),
    Increase(Vec<u32>, usize, f64),
    Subtract(f64),
    Apply(f64),
    Decay(f64),
    ApplyAndDecay(f64, f64),
    Clear,
    CompleteTable,
    /// Whether to restore into the traces in use or into new ones.
    SaveAndRestore(bool),
}

/// The definition of traces: a trace and a value for every weight.
struct Dense {
    values: Vec<f64>,
    traces: Vec<f64>,
    cutoff: f64,
}

impl Dense {
    fn value(&self, rows: &[u32], action: usize) -> f64 {
        rows.iter().map(|&row| self.values[weight(row, action)]).reduce(|sum, value| sum + value).unwrap_or(0.0)
    }

    fn change(&mut self, rows: &[u32], action: usize, change: impl Fn(f64) -> f64) {
        for &row in rows {
            let trace = &mut self.traces[weight(row, action)];
            *trace = change(*trace);
        }
    }

    fn apply(&mut self, learning_rate: &LearningRate, error: f64) {
        for (weight, (value, trace)) in self.values.iter_mut().zip(&self.traces).enumerate() {
            if *trace != 0.0 {
                *value += learning_rate.at(weight) * error * trace;
            }
        }
    }

    fn decay(&mut self, factor: f64) {
        for trace in &mut self.traces {
            *trace *= factor;
            if trace.abs() <= self.cutoff {
                *trace = 0.0;
            }
        }
    }
}

fn weight(row: u32, action: usize) -> usize {
    row as usize * ACTIONS + action
}

fn bits(numbers: &[f64]) -> Vec<u64> {
    numbers.iter().map(|number| number.to_bits()).collect()
}

/// Applies operations to the traces and to the definition, and compares all values and traces after each.
fn check(operations: &[Operation], cutoff: f64, visits: bool) {
    for level in SimdLevel::available() {
        check_at(level, operations, cutoff, visits);
    }
}

fn check_at(level: SimdLevel, operations: &[Operation], cutoff: f64, visits: bool) {
    let stop = StopFlag::new();
    let new_traces = || {
        let mut traces = Traces::new(ROWS * ACTIONS, cutoff, &stop).expect("a few traces");
        traces.set_level(level);
        traces
    };
    // Some values are -0, which must not change for a weight without a trace.
    let value = |weight| if weight % 4 == 0 { -0.0 } else { f64::from(weight).sin() };
    let values: Vec<f64> = (0..(ROWS * ACTIONS) as u32).map(value).collect();
    let mut dense = Dense { values: values.clone(), traces: vec![0.0; ROWS * ACTIONS], cutoff };
    let (mut table, mut traces) = (QTable::<0>::new(values, ACTIONS), new_traces());
    let mut learning_rate = if visits {
        LearningRate::by_visit_count(0.9, 0.0, ROWS * ACTIONS, 4, &stop).expect("a few weights")
    } else {
        LearningRate::scheduled(Schedule::constant(0.3), 4)
    };
    (0..ROWS * ACTIONS).for_each(|weight| learning_rate.visit(weight));
    let mut last = (vec![0], 0);
    for operation in operations.iter().cloned() {
        traces.begin_step(&mut table);
        match operation {
            Operation::Visit(kind, rows, action) => {
                let value = traces.visit(kind, &mut table, &rows, action);
                assert_eq!(value.to_bits(), dense.value(&rows, action).to_bits());
                dense.change(&rows, action, |trace| if kind == TraceKind::Accumulating { trace + 1.0 } else { 1.0 });
                if kind == TraceKind::Clearing {
                    (0..ACTIONS).filter(|&other| other != action).for_each(|other| dense.change(&rows, other, |_| 0.0));
                }
                last = (rows, action);
            }
            Operation::Increase(rows, action, increment) => {
                traces.update(&mut table, &rows, action, |trace| trace + increment);
                dense.change(&rows, action, |trace| trace + increment);
                last = (rows, action);
            }
            Operation::Subtract(number) => {
                traces.subtract(&mut table, &last.0, last.1, number);
                last.0.iter().for_each(|&row| dense.values[weight(row, last.1)] -= number);
            }
            Operation::Apply(error) => {
                traces.apply_td_error(&mut table, &learning_rate, error);
                dense.apply(&learning_rate, error);
            }
            Operation::Decay(factor) => {
                traces.decay(&mut table, factor);
                dense.decay(factor);
            }
            Operation::ApplyAndDecay(error, factor) => {
                traces.apply_td_error_and_decay(&mut table, &learning_rate, error, factor);
                dense.apply(&learning_rate, error);
                dense.decay(factor);
            }
            Operation::Clear => {
                traces.clear(&mut table);
                dense.traces.fill(0.0);
            }
            Operation::CompleteTable => {
                traces.complete_table(&mut table);
                assert_eq!(bits(table.values()), bits(&dense.values));
            }
            Operation::SaveAndRestore(in_use) => {
                traces.complete_table(&mut table);
                let mut bytes = Vec::new();
                traces.persist(&mut Checkpoint::save(&mut bytes)).expect("memory suffices");
                let mut restored = if in_use { traces.clone() } else { new_traces() };
                let mut checkpoint = Checkpoint::restore(&bytes);
                restored.persist(&mut checkpoint).expect("the bytes are those of the traces");
                checkpoint.finish().expect("all bytes are read");
                assert_eq!(restored, traces);
                let mut saved_again = Vec::new();
                restored.persist(&mut Checkpoint::save(&mut saved_again)).expect("memory suffices");
                assert_eq!(saved_again, bytes);
                (table, traces) = (QTable::new(table.values().to_vec(), ACTIONS), restored);
            }
        }
        traces.begin_step(&mut table);
        for row in 0..ROWS as u32 {
            let values: Vec<f64> = (0..ACTIONS).map(|action| dense.value(&[row, 3], action)).collect();
            assert_eq!(bits(traces.action_values(&mut table, [row, 3])), bits(&values));
            for action in 0..ACTIONS {
                let trace = dense.traces[weight(row, action)];
                assert_eq!(traces.get(weight(row, action)), trace);
                assert_eq!(traces.sum(&table, &[row, row], action), trace + trace);
            }
        }
        assert!(dense.traces.iter().filter(|&&trace| trace != 0.0).count() <= traces.pass_len());
        assert_eq!(traces.is_empty(), dense.traces.iter().all(|&trace| trace == 0.0));
    }
}

fn operation() -> impl Strategy<Value = Operation> {
    // Rows can be active twice, as with hashing.
    let rows = || prop::collection::vec(0..ROWS as u32, 1..20);
    let kind = prop_oneof![Just(TraceKind::Accumulating), Just(TraceKind::Replacing), Just(TraceKind::Clearing)];
    let factor = || prop_oneof![Just(0.9), Just(0.5), Just(0.0), Just(1.0)];
    prop_oneof![
        4 => (kind, rows(), 0..ACTIONS).prop_map(|(kind, rows, action)| Operation::Visit(kind, rows, action)),
        2 => (rows(), 0..ACTIONS, -1.0..1.0).prop_map(|(rows, action, by)| Operation::Increase(rows, action, by)),
        1 => (-1.0..1.0).prop_map(Operation::Subtract),
        1 => (-9.0..9.0).prop_map(Operation::Apply),
        1 => factor().prop_map(Operation::Decay),
        4 => (-9.0..9.0, factor()).prop_map(|(error, factor)| Operation::ApplyAndDecay(error, factor)),
        1 => Just(Operation::Clear),
        1 => Just(Operation::CompleteTable),
        1 => any::<bool>().prop_map(Operation::SaveAndRestore),
    ]
}

/// The operations of a learner with replacing traces: mostly steps that visit the same number of rows and decay by the
/// same factor.
fn steps() -> impl Strategy<Value = Vec<Operation>> {
    let kind = prop_oneof![Just(TraceKind::Replacing), Just(TraceKind::Clearing)];
    let factor = prop_oneof![Just(0.9), Just(0.5), Just(-0.7), Just(0.0), Just(1.0), Just(1.1)];
    (1..6_usize, kind, factor).prop_flat_map(|(num_rows, kind, factor)| {
        let visit = (prop::collection::vec(0..ROWS as u32, num_rows), 0..ACTIONS)
            .prop_map(move |(rows, action)| Operation::Visit(kind, rows, action));
        let update = (-9.0..9.0, any::<bool>()).prop_map(move |(error, together)| {
            if together {
                vec![Operation::ApplyAndDecay(error, factor)]
            } else {
                vec![Operation::Apply(error), Operation::Decay(factor)]
            }
        });
        let step = (visit, update).prop_map(|(visit, update)| [vec![visit], update].concat());
        let others = prop::collection::vec(operation(), 1..3);
        prop::collection::vec(prop_oneof![12 => step, 1 => others], 1..60).prop_map(|steps| steps.concat())
    })
}

proptest! {
    #[test]
    fn sparse_traces_do_what_a_trace_for_every_weight_does(
        operations in prop::collection::vec(operation(), 1..60),
        cutoff in prop_oneof![Just(0.0), Just(0.2)],
        visits in any::<bool>(),
    ) {
        check(&operations, cutoff, visits);
    }

    #[test]
    fn traces_of_a_learner_do_what_a_trace_for_every_weight_does(
        steps in steps(),
        cutoff in prop_oneof![Just(0.2), Just(0.01), Just(0.5), Just(1.0)],
        visits in any::<bool>(),
    ) {
        check(&steps, cutoff, visits);
    }
}

/// The traces of two actions after these visits, with γλ = 0.5.
fn traces_after(kind: TraceKind, actions: &[usize]) -> [f64; 2] {
    let mut table = QTable::<0>::new(vec![0.0; 2], 2);
    let mut traces = Traces::new(2, 0.0, &StopFlag::new()).expect("a few weights");
    for &action in actions {
        traces.begin_step(&mut table);
        traces.decay(&mut table, 0.5);
        traces.visit(kind, &mut table, [0], action);
    }
    [traces.get(0), traces.get(1)]
}

#[test]
fn each_kind_changes_the_traces_as_defined() {
    assert_eq!(traces_after(TraceKind::Accumulating, &[0, 1, 1]), [0.25, 1.5]);
    assert_eq!(traces_after(TraceKind::Replacing, &[0, 1, 1]), [0.25, 1.0]);
    assert_eq!(traces_after(TraceKind::Clearing, &[0, 1, 1]), [0.0, 1.0]);
}

#[test]
fn a_small_trace_is_found_after_all_were_0_and_decayed_to_nothing() {
    let mut table = QTable::<0>::new(vec![0.0; 2], 1);
    let mut traces = Traces::new(2, 0.2, &StopFlag::new()).expect("a few weights");
    traces.begin_step(&mut table);
    traces.decay(&mut table, 0.0);
    traces.update(&mut table, [0], 0, |_| 0.21);
    traces.visit(TraceKind::Replacing, &mut table, [1], 0);
    traces.decay(&mut table, 0.9);
    assert_eq!([traces.get(0), traces.get(1)], [0.0, 0.9]);
}

#[test]
fn a_trace_at_the_cutoff_is_removed_and_the_others_stay() {
    let mut table = QTable::<0>::new(vec![1.0, 2.0, 3.0, 4.0], 1);
    let mut traces = Traces::new(4, 0.25, &StopFlag::new()).expect("a few weights");
    traces.begin_step(&mut table);
    for row in 0..4 {
        traces.update(&mut table, [row], 0, |_| if row % 2 == 0 { 0.5 } else { 1.0 });
    }
    traces.decay(&mut table, 0.5);
    assert_eq!([0, 1, 2, 3].map(|weight| traces.get(weight)), [0.0, 0.5, 0.0, 0.5]);
    traces.clear(&mut table);
    assert!(traces.is_empty() && traces.get(1) == 0.0);
    assert_eq!(table.values(), [1.0, 2.0, 3.0, 4.0]);
}
