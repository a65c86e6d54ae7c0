//! How long a step takes.

use std::time::{Duration, Instant};

use super::{BitGenerator, Ending, Environment, Episode, RandomBits};

/// A time after which no further step is measured.
const LONG: Duration = Duration::from_millis(1);

/// The time of a step, from at most `steps` steps with the first available action, and only one if it takes a
/// millisecond. Zero if it cannot be measured, as memory does not suffice or a function fails.
pub fn step_time(environment: &Environment, steps: u32, rng: &mut impl BitGenerator) -> Duration {
    measured(environment, steps, rng).unwrap_or(Duration::ZERO)
}

fn measured(environment: &Environment, steps: u32, rng: &mut impl BitGenerator) -> Option<Duration> {
    let mut episode = Episode::new(environment).ok()?;
    let limit = environment.max_episode_steps().unwrap_or(u64::MAX);
    let (mut is_over, mut elapsed, mut taken) = (true, 0, 0);
    let start = Instant::now();
    while taken < steps && start.elapsed() < LONG {
        if is_over {
            episode.reset(&mut RandomBits::new(rng)).ok()?;
            elapsed = 0;
        }
        let masked = environment.has_action_mask();
        let action = if masked { episode.action_mask().iter().position(|&byte| byte == 1)? } else { 0 };
        let (_, ending) = episode.step(action, &mut RandomBits::new(rng)).ok()?;
        (elapsed, taken) = (elapsed + 1, taken + 1);
        is_over = ending != Ending::Continues || elapsed >= limit;
    }
    Some(start.elapsed() / taken.max(1))
}
