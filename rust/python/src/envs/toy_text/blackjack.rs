//! `Blackjack-v1`: rules instead of a table. The Gymnasium-facing class stores the hands in Python lists and draws the
//! cards from the user's generator.

use std::sync::Arc;

use numpy::{PyArray1, PyArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{PyDict, PyInt, PyList, PyTuple, PyType};
use qtab_core::envs::toy_text::{Blackjack, DEALER_STICKS, DECK, Hand};
use qtab_core::envs::wrappers::{BlackjackWithHistory, DealHistory};
use qtab_core::features::MultiDiscreteIndex;
use qtab_core::planning::Mdp;

use super::super::gymnasium::{attribute_after_reset, generator, is_numpy_generator, render_if_human};
use super::super::native_env::NativeEnv;
use super::sampling::step_fallback;
use crate::convert::discrete_action;
use crate::runs::{OneStepBatching, RunFactory, specialized};
use crate::spec::RunSpec;
use crate::vector::{DynVectorEnv, EnvInfo, VectorOptions, native_vector_env};

/// Larger than any card that a user could mean.
const LARGEST_CARD: u32 = 1000;
const SUITS: [&str; 4] = ["C", "D", "H", "S"];
const FACES: [&str; 3] = ["J", "Q", "K"];

/// Blackjack by its rules.
pub(crate) fn blackjack_env(env: &Bound<'_, PyAny>) -> PyResult<Arc<dyn NativeEnv>> {
    Ok(Arc::new(rules(env)?))
}

fn rules(env: &Bound<'_, PyAny>) -> PyResult<Blackjack> {
    let py = env.py();
    let natural = env.getattr(intern!(py, "natural"))?.is_truthy()?;
    let sab = env.getattr(intern!(py, "sab"))?.is_truthy()?;
    Ok(Blackjack { natural, sab })
}

impl NativeEnv for Blackjack {
    fn runs(&self, spec: &Arc<RunSpec>) -> PyResult<Box<dyn RunFactory>> {
        spec.discretizer.check_identity(Self::OBSERVATION_SHAPE.iter().product())?;
        let features = MultiDiscreteIndex(Self::OBSERVATION_SHAPE.map(|count| count as u32));
        specialized::<_, _, 2>(*self, features, spec, OneStepBatching::one_by_one())
    }

    fn vector_env(&self, py: Python<'_>, options: VectorOptions) -> PyResult<Option<Box<dyn DynVectorEnv>>> {
        let info = EnvInfo { envs_per_thread: 4096, transition: None, snapshot, terminal_counter: None };
        native_vector_env::<_, Vec<_>>(py, BlackjackWithHistory(*self), info, options).map(Some)
    }

    fn mdp(&self) -> PyResult<Option<Mdp>> {
        Mdp::try_from(self).map(Some).map_err(|error| PyValueError::new_err(error.to_string()))
    }
}

/// Writes the cards of both hands, and the suit and the name of the dealer's open card.
#[expect(clippy::trivially_copy_pass_by_ref, reason = "snapshots of any environment have these arguments")]
fn snapshot(
    attributes: &Bound<'_, PyDict>,
    _env: &BlackjackWithHistory,
    state: &DealHistory,
    _last_action: Option<usize>,
) -> PyResult<()> {
    let py = attributes.py();
    let draws: Vec<usize> = state.draws().collect();
    let [first, second, third, fourth, suit, ref rest @ ..] = draws[..] else { return Ok(()) };
    let (name, cards) = match rest {
        [face, cards @ ..] if state.hands.shown == 10 => (numpy_string(py, FACES[*face])?, cards),
        _ if state.hands.shown == 1 => ("A".into_pyobject(py)?.into_any(), rest),
        _ => (state.hands.shown.to_string().into_pyobject(py)?.into_any(), rest),
    };
    let (player, dealer) = cards.split_at(state.hands.player.cards as usize - 2);
    let hand = |dealt: [usize; 2], taken: &[usize]| -> Vec<u32> {
        dealt.iter().chain(taken).map(|&index| DECK[index]).collect()
    };
    attributes.set_item(intern!(py, "dealer"), hand([first, second], dealer))?;
    attributes.set_item(intern!(py, "player"), hand([third, fourth], player))?;
    attributes.set_item(intern!(py, "dealer_top_card_suit"), numpy_string(py, SUITS[suit])?)?;
    attributes.set_item(intern!(py, "dealer_top_card_value_str"), name)
}

/// The base of the Gymnasium-facing class.
#[pyclass(subclass, frozen, name = "Blackjack", module = "qtab._core")]
pub(crate) struct PyBlackjack;

#[pymethods]
impl PyBlackjack {
    #[new]
    #[pyo3(signature = (*_args, **_kwargs))]
    fn new(_args: &Bound<'_, PyTuple>, _kwargs: Option<&Bound<'_, PyDict>>) -> Self {
        Self
    }

    /// One step, with Gymnasium's return types.
    fn step<'py>(slf: &Bound<'py, Self>, action: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        let py = slf.py();
        let [player, dealer] =
            [intern!(py, "player"), intern!(py, "dealer")].map(|name| attribute_after_reset(slf, name));
        let (Some((player_cards, mut player)), Some((dealer_cards, mut dealer))) = (hand(player?), hand(dealer?))
        else {
            return step_fallback(slf, action);
        };
        let generator = generator(slf)?;
        let Some(action) =
            discrete_action(action, 2).filter(|_| is_numpy_generator(&generator) && has_gymnasium_actions(slf))
        else {
            return step_fallback(slf, action);
        };
        let draw = |cards: &Bound<'py, PyList>, hand: Hand| -> PyResult<Hand> {
            let index: usize = generator.call_method1(intern!(py, "integers"), (0, DECK.len()))?.extract()?;
            cards.append(DECK[index])?;
            Ok(hand.with(DECK[index]))
        };
        let (reward, terminated) = if action == 1 {
            player = draw(&player_cards, player)?;
            (if player.is_bust() { -1.0 } else { 0.0 }, player.is_bust())
        } else {
            while dealer.sum() < DEALER_STICKS {
                dealer = draw(&dealer_cards, dealer)?;
            }
            (rules(slf)?.payoff(&player, &dealer), true)
        };
        render_if_human(slf)?;
        let observation = (player.sum(), dealer_cards.get_item(0)?, u32::from(player.usable_ace()));
        Ok((observation, reward, terminated, false, PyDict::new(py)).into_pyobject(py)?.into_any())
    }

    /// Deals the first cards, and draws the suit and the name of the open card. Returns the result of `reset`; or None,
    /// drawing nothing, if the generator is not `NumPy`'s.
    #[pyo3(name = "_native_reset")]
    fn native_reset<'py>(slf: &Bound<'py, Self>) -> PyResult<Option<Bound<'py, PyAny>>> {
        let py = slf.py();
        let generator = generator(slf)?;
        if !is_numpy_generator(&generator) {
            return Ok(None);
        }
        // One call for all four is faster than four calls, and draws the same cards.
        let indices = generator.call_method1(intern!(py, "integers"), (0, DECK.len(), 4))?;
        let indices = indices.cast_into::<PyArray1<i64>>()?.to_vec()?;
        let [one, two, three, four] = <[i64; 4]>::try_from(indices)
            .map_err(|_| PyValueError::new_err("integers must draw four cards"))?
            .map(|index| DECK[index as usize]);
        slf.setattr(intern!(py, "dealer"), [one, two])?;
        slf.setattr(intern!(py, "player"), [three, four])?;
        let choice = |names: &[&str]| -> PyResult<Bound<'py, PyAny>> {
            let index: usize = generator.call_method1(intern!(py, "integers"), (0, names.len()))?.extract()?;
            numpy_string(py, names[index])
        };
        slf.setattr(intern!(py, "dealer_top_card_suit"), choice(&SUITS)?)?;
        let name = match one {
            1 => "A".into_pyobject(py)?.into_any(),
            10 => choice(&FACES)?,
            number => number.to_string().into_pyobject(py)?.into_any(),
        };
        slf.setattr(intern!(py, "dealer_top_card_value_str"), name)?;
        render_if_human(slf)?;
        let player = Hand::default().with(three).with(four);
        let observation = (player.sum(), one, u32::from(player.usable_ace()));
        Ok(Some((observation, PyDict::new(py)).into_pyobject(py)?.into_any()))
    }
}

/// A list of cards as a hand; None for anything else.
fn hand(cards: Bound<'_, PyAny>) -> Option<(Bound<'_, PyList>, Hand)> {
    let cards = cards.cast_into_exact::<PyList>().ok()?;
    let mut hand = Hand::default();
    for card in &cards {
        let card = card.cast_exact::<PyInt>().ok()?.extract().ok().filter(|&card: &u32| card <= LARGEST_CARD)?;
        hand = hand.with(card);
    }
    (hand.cards > 0).then_some((cards, hand))
}

/// Whether the action space is `Discrete(2)`. Calling `contains` on the space would take longer than the step.
fn has_gymnasium_actions(env: &Bound<'_, PyAny>) -> bool {
    static DISCRETE: PyOnceLock<Py<PyType>> = PyOnceLock::new();
    let py = env.py();
    let Ok(space) = env.getattr(intern!(py, "action_space")) else { return false };
    let discrete = DISCRETE.import(py, "gymnasium.spaces", "Discrete");
    let number = |name| space.getattr(name).ok().and_then(|number| discrete_action(&number, 3));
    discrete.is_ok_and(|class| space.is_exact_instance(class))
        && number(intern!(py, "n")) == Some(2)
        && number(intern!(py, "start")) == Some(0)
}

/// The `np.str_` that `choice` returns.
fn numpy_string<'py>(py: Python<'py>, text: &str) -> PyResult<Bound<'py, PyAny>> {
    static STRING: PyOnceLock<Py<PyType>> = PyOnceLock::new();
    STRING.import(py, "numpy", "str_")?.call1((text,))
}
