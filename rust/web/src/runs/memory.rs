//! The memory of runs, computed before they start: in a browser a failed allocation would end the module.

use qtab_core::learners::AnyAlgorithm;
use qtab_core::settings::LearningRateSpec;

use crate::failure::Failure;
use crate::settings::{MAX_FEATURES, Settings};

/// The largest memory of a request's runs.
const MAX_BYTES: u64 = 512 << 20;
/// Return, length and end of an episode, in the run and in a report's copy.
const BYTES_PER_EPISODE: u64 = 2 * (8 + 8 + 1);

/// Rejects runs that would take too much memory.
pub(crate) fn check(settings: &Settings, (rows, num_actions): (usize, usize), seeds: usize) -> Result<(), Failure> {
    let needed = needed(settings, (rows as u64, num_actions as u64), seeds as u64);
    if needed <= MAX_BYTES {
        return Ok(());
    }
    let runs = if seeds == 1 { "1 run".to_string() } else { format!("{seeds} runs") };
    Err(format!(
        "{runs} with a table of {rows} rows and {num_actions} actions would take {} MiB, and the page has {} MiB for them: \
         choose fewer cells, or fewer seeds",
        needed.div_ceil(1 << 20),
        MAX_BYTES >> 20,
    )
    .into())
}

fn needed(settings: &Settings, (rows, num_actions): (u64, u64), seeds: u64) -> u64 {
    let values = rows * num_actions;
    let by_visits = matches!(settings.learning_rate, LearningRateSpec::Visits { .. });
    let tables = settings.algorithm.n_tables() as u64 * values * (8 + 4 * u64::from(by_visits));
    let run = tables + bytes_of_algorithm(settings, values) + settings.episodes as u64 * BYTES_PER_EPISODE;
    // The first run counts its visits, and is repeated when another of its states is selected.
    (seeds + 1) * run + 2 * 8 * values
}

/// The memory of an algorithm besides its tables: traces, a model, or the steps that wait for their updates.
fn bytes_of_algorithm(settings: &Settings, values: u64) -> u64 {
    match settings.algorithm {
        AnyAlgorithm::SarsaLambda(_) | AnyAlgorithm::TrueOnlineSarsaLambda { .. } | AnyAlgorithm::WatkinsQLambda(_) => {
            24 * values
        }
        AnyAlgorithm::DynaQ { .. } => 36 * values,
        AnyAlgorithm::DynaQPlus { .. } => 44 * values,
        AnyAlgorithm::NStepSarsa { n_steps } => {
            let bytes_per_step = if settings.discretizer.is_weighted() {
                32 + 8 * MAX_FEATURES as u64
            } else {
                32 + 4 * settings.discretizer.n_active() as u64
            };
            bytes_per_step * settings.max_episode_steps.min(n_steps as u64)
        }
        _ => 0,
    }
}
