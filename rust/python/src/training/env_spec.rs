//! The environment of a run, stepped in Rust or in Python.

use std::sync::Arc;

use pyo3::prelude::*;

use crate::envs::{NativeEnv, PyNativeEnv};
use crate::error::invalid;
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

    /// The environment of a spec, which must be one that Rust steps; `expected` names it in the error.
    pub(super) fn native(spec: &Fields<'_>, expected: &str) -> PyResult<Arc<dyn NativeEnv>> {
        match Self::parse(&spec.nested("env")?)? {
            Self::Native(env) => Ok(env),
            Self::Python(_) => Err(invalid("env", expected, "one that is stepped in Python")),
        }
    }
}
