//! Which path a run takes: one that is compiled for its types, or the generic one, which honours everything.

use std::sync::Arc;

use qtab_core::learners::AnyAlgorithm;
use qtab_core::q_table::TerminalUpdate;

use crate::prediction::PredictionSpec;
use crate::rng::BitGenerator;
use crate::spec::{ActionMasksSpec, InitialQSpec, LearningRateSpec, PolicySpec, RunSpec};

/// The paths that a run may take.
pub(super) enum RunPath {
    /// A learner that asks for nothing beyond a [`PlainSpec`]. Code that is compiled for its types may take it over.
    Plain(PlainSpec),
    /// The values of a policy over numbered states, with the common generator, which bootstraps at the time limit.
    PlainPrediction(Arc<PredictionSpec>),
    /// The values of a policy that reads the observations of a Box.
    ObservedPrediction(Arc<PredictionSpec>),
    /// Anything else, in the environment's task as it is.
    Generic,
    /// Anything else, in a task with wrappers, which record it, count visits or add the steps taken to its state.
    GenericWithWrappers,
}

/// All that a run compiled for its types may be asked for. It is built from this alone, and whoever builds it names every
/// field.
#[derive(Clone)]
pub(super) struct PlainSpec {
    pub(super) num_actions: usize,
    pub(super) max_episode_steps: u64,
    pub(super) algorithm: AnyAlgorithm,
    pub(super) policy: PolicySpec,
    pub(super) learning_rate: LearningRateSpec,
    pub(super) discount: f64,
    pub(super) initial_q: InitialQSpec,
    pub(super) terminal_update: TerminalUpdate,
    pub(super) terminate_on_truncation: bool,
    pub(super) episodes: u64,
    pub(super) count_visits: bool,
}

impl RunPath {
    /// The path of a run. The pattern names every field of the spec, so that none is added without a decision here.
    pub(super) fn of(spec: &RunSpec) -> Self {
        let RunSpec {
            discretizer: _, // The environment makes the features of it, which all paths have.
            num_actions,
            max_episode_steps,
            time_aware,
            algorithm,
            policy,
            learning_rate,
            discount,
            count_bonus,
            initial_q,
            action_masks,
            terminal_update,
            terminate_on_truncation,
            episodes,
            bit_generator,
            record,
            room: _, // It only matters to runs that record.
            count_visits,
            prediction,
        } = spec;
        let is_common = *bit_generator == BitGenerator::Pcg64;
        if let Some(prediction) = prediction {
            // `RunSpec::predicting` has refused all that only a learner of actions has.
            return if prediction.reads_observations() {
                Self::ObservedPrediction(Arc::clone(prediction))
            } else if is_common && !terminate_on_truncation {
                Self::PlainPrediction(Arc::clone(prediction))
            } else {
                Self::Generic
            };
        }
        if *record > 0 || *time_aware {
            return Self::GenericWithWrappers;
        }
        if is_common && *count_bonus == 0.0 && matches!(action_masks, ActionMasksSpec::None) {
            return Self::Plain(PlainSpec {
                num_actions: *num_actions,
                max_episode_steps: *max_episode_steps,
                algorithm: *algorithm,
                policy: *policy,
                learning_rate: *learning_rate,
                discount: *discount,
                initial_q: initial_q.clone(),
                terminal_update: *terminal_update,
                terminate_on_truncation: *terminate_on_truncation,
                episodes: *episodes,
                count_visits: *count_visits,
            });
        }
        if *count_visits { Self::GenericWithWrappers } else { Self::Generic }
    }

    /// Whether the task has wrappers around it.
    pub(super) fn has_wrappers(&self) -> bool {
        match self {
            Self::Plain(PlainSpec { count_visits, .. }) => *count_visits,
            Self::GenericWithWrappers => true,
            Self::PlainPrediction(_) | Self::ObservedPrediction(_) | Self::Generic => false,
        }
    }
}
