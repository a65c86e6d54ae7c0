//! The spec of a run from Python (`qtab/_spec.py`), parsed once: every tag becomes a variant, every word a value, and
//! unknown ones are rejected here.

mod action_masks;
mod discretizer;
mod fields;
mod initial_q;
mod prediction;
mod product;
mod weighted;

use std::sync::Arc;

use pyo3::prelude::*;
use qtab_core::StopFlag;
use qtab_core::learners::{AnyAlgorithm, FeatureKinds};
use qtab_core::memory::MemoryRoom;
use qtab_core::q_table::TerminalUpdate;
use qtab_core::schedules::LearningRate;
use qtab_core::settings::SettingSource;

pub(crate) use action_masks::ActionMasksSpec;
pub(crate) use discretizer::{DISCRETIZERS, DiscretizerSpec, FloatType, TilesSpec};
pub(crate) use fields::{Fields, Variant};
pub(crate) use initial_q::InitialQSpec;
pub(crate) use prediction::{BoxFeatures, PolicyFeatures, PredictionSpec, ReadValues};
pub(crate) use qtab_core::settings::{LearningRateSpec, PolicySpec, ScheduleSpec};
pub(crate) use weighted::match_capacity;

use crate::error::{allocation, invalid};
use crate::rng::BitGenerator;

/// The largest learning rate. Tile coding divides it among the tilings.
const LARGEST_RATE: f64 = 2.0;

/// The agent and its training: the description of a run without the environment and the seed.
#[derive(Clone, Debug)]
pub(crate) struct RunSpec {
    pub(crate) discretizer: DiscretizerSpec,
    pub(crate) num_actions: usize,
    pub(crate) max_episode_steps: u64,
    /// Whether the number of steps taken in the episode is part of the state.
    pub(crate) time_aware: bool,
    pub(crate) algorithm: AnyAlgorithm,
    pub(crate) policy: PolicySpec,
    pub(crate) learning_rate: LearningRateSpec,
    pub(crate) discount: f64,
    /// The weight of the bonus for rarely visited state-action pairs; 0 for no bonus.
    pub(crate) count_bonus: f64,
    pub(crate) initial_q: InitialQSpec,
    pub(crate) action_masks: ActionMasksSpec,
    pub(crate) terminal_update: TerminalUpdate,
    pub(crate) terminate_on_truncation: bool,
    pub(crate) episodes: u64,
    pub(crate) bit_generator: BitGenerator,
    /// The number of last episodes to record. Like `room` and `count_visits`, it does not affect learning, so Python's
    /// spec omits it.
    pub(crate) record: usize,
    /// The memory for recordings.
    pub(crate) room: MemoryRoom,
    /// Whether to count the visits of each state-action pair.
    pub(crate) count_visits: bool,
    /// The spec of a prediction, for runs that estimate values instead of learning to act. Python has a separate spec
    /// for it.
    pub(crate) prediction: Option<Arc<PredictionSpec>>,
}

impl RunSpec {
    /// The same task, in which the values of a policy are estimated.
    ///
    /// # Errors
    /// `ValueError` for settings that apply only to control.
    pub(crate) fn predicting(self, prediction: PredictionSpec) -> PyResult<Self> {
        // Every field is named, so that adding one forces a decision here.
        let Self {
            // The task, and the settings that prediction also supports.
            discretizer: _,
            num_actions: _,
            max_episode_steps: _,
            learning_rate: _,
            discount: _,
            terminate_on_truncation: _,
            episodes: _,
            bit_generator: _,
            // A prediction has a method, policies and initial weights instead.
            algorithm: _,
            policy: _,
            initial_q: _,
            prediction: _,
            // The settings that prediction does not support.
            time_aware,
            count_bonus,
            action_masks,
            terminal_update,
            record,
            room: _, // It only matters to runs that record.
            count_visits,
        } = &self;
        let refused = [
            ("time_aware", *time_aware),
            ("count_bonus", *count_bonus != 0.0),
            ("action_masks", !action_masks.is_none()),
            ("terminal_update", *terminal_update != TerminalUpdate::Target),
            ("record", *record > 0),
            ("visits", *count_visits),
        ];
        if let Some((name, _)) = refused.iter().find(|(_, is_given)| *is_given) {
            return Err(invalid(name, "left at its default to estimate values", "another value"));
        }
        let spec = Self { prediction: Some(Arc::new(prediction)), ..self };
        spec.check_weighted()?;
        Ok(spec)
    }

    /// The prediction, if its policies read the observations of a Box.
    pub(crate) fn prediction_by_observation(&self) -> Option<&Arc<PredictionSpec>> {
        self.prediction.as_ref().filter(|prediction| prediction.reads_observations())
    }

    pub(crate) fn parse(fields: &Fields<'_>) -> PyResult<Self> {
        let num_actions = fields.get("num_actions")?;
        if num_actions == 0 {
            return Err(invalid("num_actions", "at least 1", num_actions));
        }
        let max_episode_steps = fields.get("max_episode_steps")?;
        // Errors name these settings as the user did, without the path of the dict.
        let settings = Fields::new(&fields.any("settings")?)?;
        let episodes = settings.integer("episodes", 1, u64::MAX)?;
        let (algorithm, learning_rate) = AnyAlgorithm::parse(&settings, episodes, max_episode_steps, LARGEST_RATE)?;
        let spec = Self {
            discretizer: DiscretizerSpec::parse(&fields.nested("discretizer")?)?,
            num_actions,
            max_episode_steps,
            time_aware: settings.flag("time_aware")?,
            algorithm,
            policy: PolicySpec::parse(&settings, episodes)?,
            learning_rate,
            discount: settings.number("discount", 0.0, 1.0)?,
            count_bonus: settings.number("count_bonus", 0.0, f64::MAX)?,
            initial_q: InitialQSpec::parse(&settings)?,
            action_masks: ActionMasksSpec::parse(&fields.nested("action_masks")?)?,
            terminal_update: settings
                .word("terminal_update", &[("target", TerminalUpdate::Target), ("assign", TerminalUpdate::Assign)])?,
            terminate_on_truncation: settings.word("on_truncation", &[("bootstrap", false), ("terminate", true)])?,
            episodes,
            bit_generator: settings.word("bit_generator", BitGenerator::WORDS)?,
            record: 0,
            room: MemoryRoom::unlimited(),
            count_visits: false,
            prediction: None,
        };
        spec.check_tile_coding()?;
        spec.check_weighted()?;
        spec.check_preferences()?;
        spec.check_time_aware()?;
        if spec.algorithm.needs_probabilities() && matches!(spec.policy, PolicySpec::Ucb { .. }) {
            return Err(invalid("policy", "'epsilon_greedy' or 'softmax' for this algorithm", "'ucb'"));
        }
        Ok(spec)
    }

    /// Rejects settings that have no meaning with weighted features, or are not supported yet. Every field is named, so
    /// that adding one forces a decision here.
    pub(crate) fn check_weighted(&self) -> PyResult<()> {
        let Self {
            // Any values.
            discretizer,
            num_actions: _,
            max_episode_steps: _,
            discount: _,
            terminate_on_truncation: _,
            episodes: _,
            bit_generator: _,
            record: _,
            room: _,
            // Some values.
            algorithm,
            policy,
            learning_rate,
            initial_q,
            time_aware,
            count_bonus,
            action_masks,
            terminal_update,
            count_visits,
            prediction,
        } = self;
        if discretizer.weighted().is_none() {
            return Ok(());
        }
        let refused = [
            ("traces", algorithm.feature_kinds() == FeatureKinds::Binary),
            ("algorithm", algorithm.feature_kinds() == FeatureKinds::SingleRows),
            ("policy", matches!(policy, PolicySpec::Ucb { .. })),
            ("learning_rate", matches!(learning_rate, LearningRateSpec::Visits { .. })),
            ("initial_q", initial_q.has_masked_actions()),
            ("time_aware", *time_aware),
            ("count_bonus", *count_bonus != 0.0),
            ("action_masks", !action_masks.is_none()),
            ("terminal_update", *terminal_update != TerminalUpdate::Target),
            ("visits", *count_visits),
            ("method", prediction.as_ref().is_some_and(|prediction| !prediction.takes_weighted())),
        ];
        match refused.iter().find(|(_, is_given)| *is_given) {
            Some((name, _)) => Err(invalid(name, "a setting that works with weighted features", "another")),
            None => Ok(()),
        }
    }

    /// The learning rate of a table of so many weights, of which `n_active` share it unless they are weighted.
    pub(crate) fn new_learning_rate(
        &self,
        weights: usize,
        n_active: usize,
        stop: &StopFlag<'_>,
    ) -> PyResult<LearningRate> {
        let Some(features) = self.discretizer.weighted() else {
            return self.learning_rate.build(self.episodes, weights, n_active, stop).map_err(allocation);
        };
        let rate = self.learning_rate.build_weighted(self.episodes, features.step_size_divisors()?);
        rate.ok_or_else(|| invalid("learning_rate", "a schedule by the episode for weighted features", "'visits'"))
    }

    /// Rejects settings that need a table with a row for each state.
    fn check_tile_coding(&self) -> PyResult<()> {
        if !self.discretizer.is_tile_coding() {
            return Ok(());
        }
        if self.terminal_update == TerminalUpdate::Assign {
            return Err(invalid("terminal_update", "'target' for tile coding", "'assign'"));
        }
        if self.algorithm.needs_single_rows() {
            return Err(invalid("algorithm", "an algorithm for several active rows for tile coding", "another"));
        }
        if matches!(self.policy, PolicySpec::Ucb { .. }) {
            return Err(invalid("policy", "'epsilon_greedy' or 'softmax' for tile coding", "'ucb'"));
        }
        Ok(())
    }

    /// Rejects settings that do not fit a state that ends with the time limit.
    fn check_time_aware(&self) -> PyResult<()> {
        if !self.time_aware {
            return Ok(());
        }
        if self.discretizer.is_tile_coding() {
            return Err(invalid("discretizer", "one with cells for time_aware", "tile coding"));
        }
        if self.max_episode_steps == 0 {
            return Err(invalid("max_episode_steps", "at least 1 for time_aware", 0));
        }
        if !self.terminate_on_truncation {
            return Err(invalid("on_truncation", "'terminate' for time_aware", "'bootstrap'"));
        }
        Ok(())
    }

    /// Rejects preferences with any policy but the softmax, or with a learning rate that decreases with visits.
    fn check_preferences(&self) -> PyResult<()> {
        if !self.algorithm.learns_preferences() {
            return Ok(());
        }
        if !matches!(self.policy, PolicySpec::Softmax { .. }) {
            return Err(invalid("policy", "'softmax' for an algorithm that learns preferences", "another"));
        }
        if matches!(self.learning_rate, LearningRateSpec::Visits { .. }) {
            return Err(invalid("learning_rate", "a schedule by the episode for this algorithm", "'visits'"));
        }
        Ok(())
    }
}
