//! The environment of a run: one that Rust steps, or one that is stepped in Python.

use std::sync::Arc;

use pyo3::prelude::*;

use crate::envs::{NativeEnv, PyNativeEnv};
use crate::runs::PythonEnv;
use crate::spec::{Fields, Variant};

pub(crate) enum EnvironmentSpec {
    Native(Arc<dyn NativeEnv>),
    Python(PythonEnv),
}

const ENVIRONMENTS: &[Variant<EnvironmentSpec>] = &[
    ("native", |fields| Ok(EnvironmentSpec::Native(fields.get::<PyRef<'_, PyNativeEnv>>("env")?.shared()))),
    ("python", |fields| PythonEnv::parse(fields).map(EnvironmentSpec::Python)),
];

impl EnvironmentSpec {
    pub(crate) fn parse(fields: &Fields<'_>) -> PyResult<Self> {
        fields.tagged(ENVIRONMENTS)
    }
}
