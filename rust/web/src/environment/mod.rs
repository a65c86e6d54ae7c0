//! The environment of a request.

mod acrobot;
mod blackjack;
mod board;
mod grid_world;
mod taxi;

use qtab_core::envs::classic_control::{CartPole, MountainCar};
use qtab_core::envs::tabular::TabularMdp;
use qtab_core::envs::toy_text::{FrozenLake, LakeRewards, cliff_walking, frozen_lake};
use serde_json::Value;

pub(crate) use self::acrobot::CompactAcrobot;
pub(crate) use self::blackjack::NumberedBlackjack;
pub(crate) use self::board::Board;
use self::grid_world::{GridWorld, layout};

/// The columns of the map of `CliffWalking`.
const CLIFF_COLUMNS: usize = 12;

/// An environment that the page can choose.
pub(crate) enum Environment {
    MountainCar(MountainCar),
    CartPole(CartPole),
    Acrobot(CompactAcrobot),
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
            Some("acrobot") => Ok(Self::Acrobot(CompactAcrobot::v1())),
            Some("blackjack") => Ok(Self::Blackjack(NumberedBlackjack::V1)),
            Some("taxi") => taxi::table().map(Self::Taxi),
            Some("frozen_lake") => Ok(Self::without_walls(lake(environment)?, layout(environment)?[0].len())),
            Some("cliff") => {
                let mdp = cliff_walking(false).map_err(|error| error.to_string())?;
                Ok(Self::without_walls(mdp, CLIFF_COLUMNS))
            }
            Some("grid") => {
                let grid = GridWorld::parse(environment)?;
                Ok(Self::Table(grid.mdp()?, Board::of_states(grid.columns(), &grid.walls())))
            }
            _ => Err("environment must be one of the playground's".into()),
        }
    }

    /// A table whose states are all cells of its map.
    fn without_walls(mdp: TabularMdp, columns: usize) -> Self {
        let board = Board::of_states(columns, &vec![false; mdp.num_states()]);
        Self::Table(mdp, board)
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
            Self::Acrobot(_) => Some(CompactAcrobot::BOUNDS),
            Self::Blackjack(_) | Self::Table(..) | Self::Taxi(_) => None,
        }
    }

    /// The transition table, if there is one.
    pub(crate) fn mdp(&self) -> Option<&TabularMdp> {
        match self {
            Self::Table(mdp, _) | Self::Taxi(mdp) => Some(mdp),
            Self::MountainCar(_) | Self::CartPole(_) | Self::Acrobot(_) | Self::Blackjack(_) => None,
        }
    }

    /// The map of numbered states for a run that begins in a state; `None` for other observations.
    pub(crate) fn board(&self, first: usize) -> Option<Board> {
        match self {
            Self::Table(_, board) => Some(board.clone()),
            Self::Taxi(_) => Some(taxi::board(first)),
            Self::Blackjack(_) => Some(NumberedBlackjack::board()),
            Self::MountainCar(_) | Self::CartPole(_) | Self::Acrobot(_) => None,
        }
    }

    /// The components that are the cosine of an angle; the next component is its sine.
    pub(crate) fn cosines(&self) -> &'static [usize] {
        match self {
            Self::Acrobot(_) => CompactAcrobot::COSINES,
            _ => &[],
        }
    }
}

/// The frozen lake of a map, slippery unless the environment says otherwise.
fn lake(environment: &Value) -> Result<TabularMdp, String> {
    let is_slippery = environment.get("is_slippery").and_then(Value::as_bool).unwrap_or(true);
    let lines: Vec<Vec<u8>> = layout(environment)?.into_iter().map(|line| line.as_bytes().to_vec()).collect();
    let success_rate = is_slippery.then_some(FrozenLake::SUCCESS_RATE);
    frozen_lake(&lines, success_rate, LakeRewards::default()).map_err(|error| error.to_string())
}
