//! `Taxi`: its table, the fickle passenger and the mask of actions.

use numpy::{PyArray1, PyArrayDescrMethods, PyUntypedArray, PyUntypedArrayMethods};
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::pyclass::CompareOp;
use pyo3::types::{PyBytes, PyDict, PyTuple};

use crate::numbers::index;
use crate::toy_text::{begin_in_python, draw, draw_first, generator, in_python, python_int, watch};

const STATES: usize = 500;
/// The passenger's place once they are in the taxi.
const ABOARD: usize = 4;
/// The map's shape in characters, its frame included.
const MAP: [usize; 2] = [7, 11];

/// The base of the taxi.
#[pyclass(subclass, frozen, module = "qtab._core")]
pub(crate) struct Taxi;

/// What a state says.
#[derive(Clone, Copy)]
struct Scene {
    row: usize,
    column: usize,
    passenger: usize,
    destination: usize,
}

impl Scene {
    fn new(state: usize) -> Self {
        Self { row: state / 100, column: state / 20 % 5, passenger: state / 4 % 5, destination: state % 4 }
    }
}

#[pymethods]
impl Taxi {
    #[new]
    #[pyo3(signature = (*_args, **_kwargs))]
    fn new(_args: &Bound<'_, PyTuple>, _kwargs: Option<&Bound<'_, PyDict>>) -> Self {
        Self
    }

    /// The first state, from the generator as it stands; what `reset` returns.
    fn begin<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        let py = slf.py();
        let Some(state) = draw_first(slf)? else { return begin_in_python(slf) };
        slf.setattr(intern!(py, "s"), &state)?;
        slf.setattr(intern!(py, "lastaction"), py.None())?;
        let mut fickle = slf.getattr(intern!(py, "fickle_passenger"))?;
        if fickle.is_truthy()? {
            let random = generator(slf)?.call_method0(intern!(py, "random"))?;
            fickle = random.rich_compare(slf.getattr(intern!(py, "fickle_probability"))?, CompareOp::Lt)?;
        }
        slf.setattr(intern!(py, "fickle_step"), fickle)?;
        slf.setattr(intern!(py, "taxi_orientation"), 0)?;
        watch(slf)?;
        let info = PyDict::new(py);
        info.set_item(intern!(py, "prob"), 1.0)?;
        info.set_item(intern!(py, "action_mask"), slf.call_method1(intern!(py, "action_mask"), (&state,))?)?;
        Ok((python_int(state)?, info).into_pyobject(py)?.into_any())
    }

    /// One step, with the types that Gymnasium returns.
    fn step<'py>(slf: &Bound<'py, Self>, action: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        let py = slf.py();
        let here = slf.getattr_opt(intern!(py, "s"))?;
        let before = here.as_ref().and_then(|state| index(state, STATES)).map(Scene::new);
        if here.is_some() && before.is_none() {
            return in_python(slf, action);
        }
        let landing = draw(slf, action, |state| index(state, STATES).is_some())?;
        let (Some(mut landing), Some(before)) = (landing, before) else { return in_python(slf, action) };
        slf.setattr(intern!(py, "lastaction"), action)?;
        if let Some(after) = index(&landing.state, STATES).map(Scene::new)
            && slf.getattr(intern!(py, "fickle_passenger"))?.is_truthy()?
            && slf.getattr(intern!(py, "fickle_step"))?.is_truthy()?
            && before.passenger == ABOARD
            && (after.row, after.column) != (before.row, before.column)
        {
            slf.setattr(intern!(py, "fickle_step"), false)?;
            let places = slf.getattr(intern!(py, "locs"))?.len()?;
            let others: Vec<usize> = (0..places).filter(|&place| place != before.destination).collect();
            let destination = generator(slf)?.call_method1(intern!(py, "choice"), (others,))?;
            let scene = (after.row, after.column, after.passenger, destination);
            landing.state = slf.call_method1(intern!(py, "encode"), scene)?;
        }
        slf.setattr(intern!(py, "s"), &landing.state)?;
        watch(slf)?;
        let info = PyDict::new(py);
        info.set_item(intern!(py, "prob"), landing.probability)?;
        info.set_item(intern!(py, "action_mask"), slf.call_method1(intern!(py, "action_mask"), (&landing.state,))?)?;
        let answer = (python_int(landing.state)?, landing.reward, landing.terminated, false, info);
        Ok(answer.into_pyobject(py)?.into_any())
    }

    /// (6,) int8: 1 for the actions that change the state.
    fn action_mask<'py>(slf: &Bound<'py, Self>, state: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        let py = slf.py();
        let (Some(state), Some(map)) = (index(state, STATES), map(slf)?) else {
            return slf.call_method1(intern!(py, "action_mask_in_python"), (state,));
        };
        let Scene { row, column, passenger, destination } = Scene::new(state);
        let open = |offset: usize| map.as_bytes()[(row + 1) * MAP[1] + 2 * column + offset] == b':';
        let here = (row, column).into_pyobject(py)?;
        let places = slf.getattr(intern!(py, "locs"))?;
        let picks = passenger < ABOARD && here.eq(places.get_item(passenger)?)?;
        let drops = passenger == ABOARD && (here.eq(places.get_item(destination)?)? || places.contains(here)?);
        let mask = [row < 4, row > 0, column < 4 && open(2), column > 0 && open(0), picks, drops];
        Ok(PyArray1::from_slice(py, &mask.map(i8::from)).into_any())
    }
}

/// The map's characters; None where they are not as Gymnasium keeps them.
fn map<'py>(taxi: &Bound<'py, Taxi>) -> PyResult<Option<Bound<'py, PyBytes>>> {
    let py = taxi.py();
    let map = taxi.getattr(intern!(py, "desc"))?;
    let Ok(characters) = map.cast::<PyUntypedArray>() else { return Ok(None) };
    if characters.shape() != MAP || characters.dtype().kind() != b'S' || characters.dtype().itemsize() != 1 {
        return Ok(None);
    }
    Ok(Some(map.call_method0(intern!(py, "tobytes"))?.cast_into()?))
}
