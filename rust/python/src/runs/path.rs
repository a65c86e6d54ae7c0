//! The path of a run: code compiled for its types, or the generic path, which supports every setting.

use std::sync::Arc;

use qtab_core::learners::AnyAlgorithm;
use qtab_core::q_table::TerminalUpdate;

use crate::rng::BitGenerator;
use crate::spec::{ActionMasksSpec, InitialQSpec, LearningRateSpec, PolicySpec, PredictionSpec, RunSpec};

/// The paths that a run may take.
pub(super) enum RunPath {
    /// A learner that needs no settings beyond a [`PlainSpec`]: code compiled for its types may run it.
    Plain(PlainSpec),
    /// The values of a policy over numbered states, with the default generator and bootstrapping at the time limit.
    PlainPrediction(Arc<PredictionSpec>),
    /// The values of a policy that reads the observations of a Box.
    ObservedPrediction(Arc<PredictionSpec>),
    /// Any other run, in a task without wrappers.
    Generic,
    /// Any other run, in a task with wrappers, which record episodes, count visits or add the steps taken to the state.
    GenericWithWrappers,
}

/// The settings that runs compiled for their types support. Such runs are built from these alone, by code that names
/// every field, so that no setting is ignored.
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
    /// The path of a run. The pattern names every field of the spec, so that adding one forces a decision here.
    pub(super) fn of(spec: &RunSpec) -> Self {
        let RunSpec {
            discretizer: _, // All paths: the environment builds the features from it.
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
        let has_default_generator = *bit_generator == BitGenerator::Pcg64;
        if let Some(prediction) = prediction {
            // `RunSpec::predicting` has rejected the settings that apply only to control.
            return if prediction.reads_observations() {
                Self::ObservedPrediction(Arc::clone(prediction))
            } else if has_default_generator && !terminate_on_truncation {
                Self::PlainPrediction(Arc::clone(prediction))
            } else {
                Self::Generic
            };
        }
        if *record > 0 || *time_aware {
            return Self::GenericWithWrappers;
        }
        if has_default_generator && *count_bonus == 0.0 && matches!(action_masks, ActionMasksSpec::None) {
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
