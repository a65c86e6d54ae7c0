//! `Blackjack`: the hands stay Python's lists, the cards come from the user's own generator.

use numpy::{PyArray1, PyArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{PyDict, PyInt, PyList, PyTuple, PyType};
use qtab_core::envs::toy_text::{Blackjack as Rules, DEALER_STICKS, DECK, Hand};

use crate::numbers::index;
use crate::toy_text::{generator, in_python, reset, watch};

/// No card that a user could mean is larger.
const LARGEST_CARD: u32 = 1000;
pub(crate) const SUITS: [&str; 4] = ["C", "D", "H", "S"];
pub(crate) const FACES: [&str; 3] = ["J", "Q", "K"];

/// The base of blackjack.
#[pyclass(subclass, frozen, module = "qtab._core")]
pub(crate) struct Blackjack;

#[pymethods]
impl Blackjack {
    #[new]
    #[pyo3(signature = (*_args, **_kwargs))]
    fn new(_args: &Bound<'_, PyTuple>, _kwargs: Option<&Bound<'_, PyDict>>) -> Self {
        Self
    }

    /// One step, with the types that Gymnasium returns.
    fn step<'py>(slf: &Bound<'py, Self>, action: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        let py = slf.py();
        let [player, dealer] = [intern!(py, "player"), intern!(py, "dealer")].map(|name| reset(slf, name));
        let (Some((cards, mut player)), Some((dealers, mut dealer))) = (hand(player?), hand(dealer?)) else {
            return in_python(slf, action);
        };
        let generator = generator(slf)?;
        let Some(action) = index(action, 2).filter(|_| is_numpys(&generator) && has_gymnasiums_space(slf)) else {
            return in_python(slf, action);
        };
        let draw = |cards: &Bound<'py, PyList>, hand: Hand| -> PyResult<Hand> {
            let index: usize = generator.call_method1(intern!(py, "integers"), (0, DECK.len()))?.extract()?;
            cards.append(DECK[index])?;
            Ok(hand.with(DECK[index]))
        };
        let (reward, terminated) = if action == 1 {
            player = draw(&cards, player)?;
            (if player.bust() { -1.0 } else { 0.0 }, player.bust())
        } else {
            while dealer.sum() < DEALER_STICKS {
                dealer = draw(&dealers, dealer)?;
            }
            let natural = slf.getattr(intern!(py, "natural"))?.is_truthy()?;
            let sab = slf.getattr(intern!(py, "sab"))?.is_truthy()?;
            (Rules { natural, sab }.payoff(&player, &dealer), true)
        };
        watch(slf)?;
        let observation = (player.sum(), dealers.get_item(0)?, u32::from(player.usable_ace()));
        Ok((observation, reward, terminated, false, PyDict::new(py)).into_pyobject(py)?.into_any())
    }

    /// The first cards and the picture of the open one; what `reset` returns, or None, nothing drawn, where the
    /// generator is not `NumPy`'s.
    fn deal<'py>(slf: &Bound<'py, Self>) -> PyResult<Option<Bound<'py, PyAny>>> {
        let py = slf.py();
        let generator = generator(slf)?;
        if !is_numpys(&generator) {
            return Ok(None);
        }
        // Four at once come sooner than one after the other, and are the same.
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
        watch(slf)?;
        let player = Hand::default().with(three).with(four);
        let observation = (player.sum(), one, u32::from(player.usable_ace()));
        Ok(Some((observation, PyDict::new(py)).into_pyobject(py)?.into_any()))
    }
}

/// A list of cards, and what it is worth; None for anything else.
fn hand(cards: Bound<'_, PyAny>) -> Option<(Bound<'_, PyList>, Hand)> {
    let cards = cards.cast_into_exact::<PyList>().ok()?;
    let mut hand = Hand::default();
    for card in &cards {
        let card = card.cast_exact::<PyInt>().ok()?.extract().ok().filter(|&card: &u32| card <= LARGEST_CARD)?;
        hand = hand.with(card);
    }
    (hand.cards > 0).then_some((cards, hand))
}

/// Whether `choice` of it is `integers` of it.
pub(crate) fn is_numpys(generator: &Bound<'_, PyAny>) -> bool {
    static GENERATOR: PyOnceLock<Py<PyType>> = PyOnceLock::new();
    let class = GENERATOR.import(generator.py(), "numpy.random", "Generator");
    class.is_ok_and(|class| generator.is_exact_instance(class))
}

/// Whether the actions are 0 and 1: asking the space itself would take longer than the cards.
fn has_gymnasiums_space(env: &Bound<'_, PyAny>) -> bool {
    static DISCRETE: PyOnceLock<Py<PyType>> = PyOnceLock::new();
    let py = env.py();
    let Ok(space) = env.getattr(intern!(py, "action_space")) else { return false };
    let discrete = DISCRETE.import(py, "gymnasium.spaces", "Discrete");
    let number = |name| space.getattr(name).ok().and_then(|number| index(&number, 3));
    discrete.is_ok_and(|class| space.is_exact_instance(class))
        && number(intern!(py, "n")) == Some(2)
        && number(intern!(py, "start")) == Some(0)
}

/// As `choice` hands it out.
pub(crate) fn numpy_string<'py>(py: Python<'py>, text: &str) -> PyResult<Bound<'py, PyAny>> {
    static STRING: PyOnceLock<Py<PyType>> = PyOnceLock::new();
    STRING.import(py, "numpy", "str_")?.call1((text,))
}
