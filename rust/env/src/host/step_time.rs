//! How long a step takes.

use std::time::{Duration, Instant};

use super::{BitGenerator, Ending, Environment, Episode, RandomBits};

/// The time of a step, from `steps` steps with the first available action. Zero if it cannot be measured, as memory does
/// not suffice or a function fails.
pub fn step_time(environment: &Environment, steps: u32, rng: &mut impl BitGenerator) -> Duration {
    total(environment, steps, rng).unwrap_or(Duration::ZERO) / steps.max(1)
}

fn total(environment: &Environment, steps: u32, rng: &mut impl BitGenerator) -> Option<Duration> {
    let mut episode = Episode::new(environment).ok()?;
    let mut is_over = true;
    let start = Instant::now();
    for _ in 0..steps {
        if is_over {
            episode.reset(&mut RandomBits::new(rng)).ok()?;
        }
        let masked = environment.has_action_mask();
        let action = if masked { episode.action_mask().iter().position(|&byte| byte == 1)? } else { 0 };
        let (_, ending) = episode.step(action, &mut RandomBits::new(rng)).ok()?;
        is_over = ending != Ending::Continues;
    }
    Some(start.elapsed())
}
