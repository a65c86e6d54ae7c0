//! The environment of a request.

mod blackjack;
mod board;
mod grid_world;
mod taxi;

use qtab_core::envs::classic_control::{CartPole, MountainCar};
use qtab_core::envs::tabular::{Outcome, TabularMdp};
use serde_json::Value;

pub(crate) use self::blackjack::NumberedBlackjack;
pub(crate) use self::board::Board;
use self::grid_world::{GridWorld, MAX_SIDE};
use crate::json::{integer, numbers};

/// The largest number of outcomes in a transition table.
const MAX_OUTCOMES: usize = 100_000;

/// An environment that the page can choose.
pub(crate) enum Environment {
    MountainCar(MountainCar),
    CartPole(CartPole),
    Blackjack(NumberedBlackjack),
    /// A transition table, with a map whose cells are its states.
    Table(TabularMdp, Board),
    Taxi(TabularMdp),
}

/// The range of each component of the observations.
pub(crate) type Bounds = &'static [(f32, f32)];

impl Environment {
    pub(crate) fn parse(environment: &Value) -> Result<Self, String> {
        match environment.get("kind").and_then(Value::as_str) {
            Some("mountain_car") => Ok(Self::MountainCar(MountainCar::default())),
            Some("cart_pole") => Ok(Self::CartPole(CartPole::default())),
            Some("blackjack") => Ok(Self::Blackjack(NumberedBlackjack::V1)),
            Some("taxi") => taxi::table().map(Self::Taxi),
            Some("table") => table(environment),
            Some("grid") => {
                let grid = GridWorld::parse(environment)?;
                Ok(Self::Table(grid.mdp()?, Board::of_states(grid.columns(), &grid.walls())))
            }
            _ => Err("environment must be one of the playground's".into()),
        }
    }

    /// The bounds of the observation space; `None` for numbered states.
    pub(crate) fn bounds(&self) -> Option<Bounds> {
        match self {
            Self::MountainCar(_) => Some(&[(-1.2, 0.6), (-0.07, 0.07)]),
            Self::CartPole(_) => Some(&[
                (-4.8, 4.8),
                (f32::NEG_INFINITY, f32::INFINITY),
                (-0.418_879_03, 0.418_879_03),
                (f32::NEG_INFINITY, f32::INFINITY),
            ]),
            Self::Blackjack(_) | Self::Table(..) | Self::Taxi(_) => None,
        }
    }

    /// The transition table, if there is one.
    pub(crate) fn mdp(&self) -> Option<&TabularMdp> {
        match self {
            Self::Table(mdp, _) | Self::Taxi(mdp) => Some(mdp),
            Self::MountainCar(_) | Self::CartPole(_) | Self::Blackjack(_) => None,
        }
    }

    /// The map of numbered states for a run that begins in a state; `None` for other observations.
    pub(crate) fn board(&self, first: usize) -> Option<Board> {
        match self {
            Self::Table(_, board) => Some(board.clone()),
            Self::Taxi(_) => Some(taxi::board(first)),
            Self::Blackjack(_) => Some(NumberedBlackjack::board()),
            Self::MountainCar(_) | Self::CartPole(_) => None,
        }
    }
}

/// A table in the form that `definitions.py` writes: `P` refers to the probabilities by index.
fn table(environment: &Value) -> Result<Environment, String> {
    let invalid = || "table must hold probabilities, outcomes and initial".to_string();
    let table = environment.get("table").ok_or_else(invalid)?;
    let numbers = |name: &str| table.get(name).and_then(numbers).ok_or_else(invalid);
    let (probabilities, initial) = (numbers("probabilities")?, numbers("initial")?);
    let states = table.get("outcomes").and_then(Value::as_array).ok_or_else(invalid)?;
    let num_actions = states.first().and_then(Value::as_array).map_or(0, Vec::len);
    let mut pairs = Vec::new();
    let mut count = 0;
    for state in states {
        let actions = state.as_array().filter(|actions| actions.len() == num_actions).ok_or_else(invalid)?;
        for action in actions {
            let outcomes = action.as_array().ok_or_else(invalid)?;
            count += outcomes.len();
            if count > MAX_OUTCOMES {
                return Err(format!("table must have at most {MAX_OUTCOMES} outcomes"));
            }
            let outcomes: Option<Vec<Outcome>> = outcomes.iter().map(|entry| outcome(entry, &probabilities)).collect();
            pairs.push(outcomes.ok_or_else(invalid)?);
        }
    }
    let columns =
        environment.get("columns").and_then(|columns| integer(columns, MAX_SIDE as u32)).unwrap_or(0) as usize;
    if columns == 0 || states.len() % columns != 0 {
        return Err(format!("columns must divide the {} states", states.len()));
    }
    let mdp = TabularMdp::new(num_actions, &initial, &pairs).map_err(|error| error.to_string())?;
    let board = Board::of_states(columns, &vec![false; mdp.num_states()]);
    Ok(Environment::Table(mdp, board))
}

fn outcome(entry: &Value, probabilities: &[f64]) -> Option<Outcome> {
    let [probability, state, reward, terminated] = entry.as_array()?.as_slice() else { return None };
    Some(Outcome {
        probability: *probabilities.get(integer(probability, u32::MAX)? as usize)?,
        state: integer(state, u32::MAX)?.into(),
        reward: reward.as_f64()?,
        terminated: integer(terminated, 1)? == 1,
    })
}
