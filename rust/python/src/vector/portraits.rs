//! Each environment as Gymnasium's class keeps it: for whoever wants to look at, or go on with, the sub-environments.

use numpy::PyArray1;
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};
use qtab_core::Env;
use qtab_core::envs::classic_control::{
    Acrobot, AcrobotState, ContinuousMountainCar, ContinuousMountainCarState, Pendulum, PendulumState,
};
use qtab_core::envs::toy_text::{DECK, TaxiState};
use qtab_core::envs::wrappers::{DealHistory, TransitionProbabilityState};
use qtab_core::numeric::Scalar;

use super::actions::Acts;
use crate::blackjack::{FACES, SUITS, numpy_string};
use crate::numbers::numpy_scalar;

type Attributes<'a, 'py> = &'a Bound<'py, PyDict>;

/// An array of f64.
pub(super) fn plain<E, const N: usize>(
    into: Attributes<'_, '_>,
    _env: &E,
    state: &E::State,
    _last: Option<E::Action>,
) -> PyResult<()>
where
    E: Env<State: Into<[f64; N]>>,
{
    let numbers: [f64; N] = (*state).into();
    into.set_item(intern!(into.py(), "state"), PyArray1::from_slice(into.py(), &numbers))
}

/// An array after a reset, a tuple after a step.
pub(super) fn car<E: Env<State: Into<[f64; 2]>>>(
    into: Attributes<'_, '_>,
    env: &E,
    state: &E::State,
    last: Option<E::Action>,
) -> PyResult<()> {
    let py = into.py();
    if last.is_none() {
        return plain(into, env, state, last);
    }
    let numbers: [f64; 2] = (*state).into();
    let numbers = numbers.into_iter().map(|number| numpy_scalar(py, Scalar::Double(number)));
    into.set_item(intern!(py, "state"), PyTuple::new(py, numbers.collect::<PyResult<Vec<_>>>()?)?)
}

/// f64 after a reset, f32 after a step.
pub(super) fn continuous_car(
    into: Attributes<'_, '_>,
    env: &ContinuousMountainCar,
    state: &ContinuousMountainCarState,
    last: Option<Scalar>,
) -> PyResult<()> {
    if last.is_none() {
        return plain::<_, 2>(into, env, state, last);
    }
    into.set_item(intern!(into.py(), "state"), PyArray1::from_slice(into.py(), &env.observe(state)))
}

/// f32 after a reset, f64 after a step.
pub(super) fn acrobot(
    into: Attributes<'_, '_>,
    env: &Acrobot,
    state: &AcrobotState,
    last: Option<usize>,
) -> PyResult<()> {
    if !state.is_f32 {
        return plain::<_, 4>(into, env, state, last);
    }
    let numbers = <[f64; 4]>::from(*state).map(|number| number as f32);
    into.set_item(intern!(into.py(), "state"), PyArray1::from_slice(into.py(), &numbers))
}

/// With its last torque, which is drawn.
pub(super) fn pendulum(
    into: Attributes<'_, '_>,
    env: &Pendulum,
    state: &PendulumState,
    last: Option<Scalar>,
) -> PyResult<()> {
    plain::<_, 2>(into, env, state, last)?;
    let torque = last.map(|u| numpy_scalar(into.py(), env.torque(u))).transpose()?;
    into.set_item(intern!(into.py(), "last_u"), torque)
}

/// A table's cell.
pub(super) fn table<E: Env<State = TransitionProbabilityState<u32>, Action = usize>>(
    into: Attributes<'_, '_>,
    _env: &E,
    state: &TransitionProbabilityState<u32>,
    last: Option<usize>,
) -> PyResult<()> {
    cell(into, state.state, last)
}

/// With what the passenger is up to.
pub(super) fn taxi<E: Env<State = TransitionProbabilityState<TaxiState>, Action = usize>>(
    into: Attributes<'_, '_>,
    _env: &E,
    state: &TransitionProbabilityState<TaxiState>,
    last: Option<usize>,
) -> PyResult<()> {
    into.set_item(intern!(into.py(), "fickle_step"), state.state.fickle)?;
    cell(into, state.state.cell, last)
}

/// With its cards, and the picture of the open one.
pub(super) fn blackjack<E: Env<State = DealHistory>>(
    into: Attributes<'_, '_>,
    _env: &E,
    state: &DealHistory,
    _last: Option<E::Action>,
) -> PyResult<()> {
    let py = into.py();
    let drawn: Vec<usize> = state.draws().collect();
    let [first, second, third, fourth, suit, ref taken @ ..] = drawn[..] else { return Ok(()) };
    let card = |&place: &usize| DECK[place];
    let (face, taken) = match taken {
        [face, taken @ ..] if state.hands.shown == 10 => (numpy_string(py, FACES[*face])?, taken),
        _ if state.hands.shown == 1 => ("A".into_pyobject(py)?.into_any(), taken),
        _ => (state.hands.shown.to_string().into_pyobject(py)?.into_any(), taken),
    };
    let (player, dealer) = taken.split_at(state.hands.player.cards as usize - 2);
    let hand = |own: [usize; 2], taken: &[usize]| own.iter().chain(taken).map(card).collect::<Vec<_>>();
    into.set_item(intern!(py, "dealer"), hand([first, second], dealer))?;
    into.set_item(intern!(py, "player"), hand([third, fourth], player))?;
    into.set_item(intern!(py, "dealer_top_card_suit"), numpy_string(py, SUITS[suit])?)?;
    into.set_item(intern!(py, "dealer_top_card_value_str"), face)
}

fn cell(into: Attributes<'_, '_>, cell: u32, last: Option<usize>) -> PyResult<()> {
    let py = into.py();
    into.set_item(intern!(py, "s"), cell)?;
    into.set_item(intern!(py, "lastaction"), last.map(|action| action.remembered(py)).transpose()?)
}
