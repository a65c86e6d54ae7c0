//! The values and the policy to compare a run with: optimal from a transition table, or the best known of
//! `MountainCar`.

use std::cell::OnceCell;

use qtab_core::envs::classic_control::MountainCar;
use qtab_core::envs::tabular::TabularMdp;
use qtab_core::planning::finite_horizon;
use qtab_core::planning::grid::GridValues;
use qtab_core::{Env, StopFlag};

use crate::environment::Environment;
use crate::map::Cells;
use crate::settings::Settings;

/// The largest number of backups: about a tenth of a second.
const MAX_BACKUPS: u64 = 20_000_000;
/// The stride of `MountainCar`'s grid of values: 181 × 71 points.
const STRIDE: usize = 8;

/// `MountainCar`'s own time limit, for which its values are computed.
const TIME_LIMIT: u64 = 200;

/// The optimal or best known values for the run's discount.
pub(crate) struct Best {
    pub(crate) kind: &'static str,
    pub(crate) values: Vec<f64>,
    pub(crate) greedy: Vec<u8>,
    /// The expected undiscounted return within the time limit.
    pub(crate) expected_return: Option<f64>,
}

/// The data that is computed once for all runs.
#[derive(Default)]
pub(crate) struct Planner {
    mountain_car: OnceCell<Option<GridValues<MountainCar, 2>>>,
}

impl Planner {
    /// The best values in the cells of a map; `None` if they are not known, or computing them would take too long.
    pub(crate) fn of(&self, environment: &Environment, settings: &Settings, cells: &Cells) -> Option<Best> {
        match environment {
            Environment::MountainCar(car) => self.of_mountain_car(*car, settings, cells),
            _ => of_table(environment.mdp()?, settings, cells),
        }
    }

    fn of_mountain_car(&self, car: MountainCar, settings: &Settings, cells: &Cells) -> Option<Best> {
        // The best policy reaches the flag from everywhere within the environment's default time limit, so a longer one
        // changes nothing.
        if settings.max_episode_steps < TIME_LIMIT {
            return None;
        }
        let computed =
            self.mountain_car.get_or_init(|| GridValues::new(car, TIME_LIMIT, STRIDE, &StopFlag::new()).ok());
        let known = computed.as_ref()?;
        let discount = settings.discount;
        let (mut values, mut greedy) = (Vec::new(), Vec::new());
        for cell in 0..cells.count() {
            let observation = cells.observation(cell)?;
            let &[position, velocity] = observation.as_slice() else { return None };
            let state = [position, velocity];
            let steps = -known.value(state);
            // A reward of -1 in each step: 1 + γ + γ² + …
            values.push(if discount == 1.0 { -steps } else { -(1.0 - discount.powf(steps)) / (1.0 - discount) });
            greedy.push(known.best_action(state) as u8);
        }
        Some(Best { kind: "best known", values, greedy, expected_return: None })
    }
}

fn of_table(mdp: &TabularMdp, settings: &Settings, cells: &Cells) -> Option<Best> {
    let Cells::States(board) = cells else { return None };
    let (steps, stop) = (settings.max_episode_steps, StopFlag::new());
    let backups = steps.saturating_mul((mdp.num_outcomes().max(mdp.num_actions())) as u64);
    if backups > MAX_BACKUPS {
        return None;
    }
    let undiscounted = finite_horizon(mdp, 1.0, steps, &stop).ok()?;
    let expected_return = Some(undiscounted.expected_return);
    let discounted = if settings.discount == 1.0 {
        undiscounted
    } else {
        finite_horizon(mdp, settings.discount, steps, &stop).ok()?
    };
    let of_cell = |state: &Option<u32>| {
        state.map_or((f64::NAN, u8::MAX), |state| {
            (discounted.values[state as usize], discounted.policy[state as usize] as u8)
        })
    };
    let (values, greedy) = board.states.iter().map(of_cell).unzip();
    Some(Best { kind: "optimal", values, greedy, expected_return })
}
