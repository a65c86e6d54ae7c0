//! Vector environments: any number of sub-environments of one type, stepped in one call.

mod actions;
mod infos;
mod native_vector_env;
mod observations;
mod sub_env_rng;

pub(crate) use actions::{BatchAction, read_numbered};
pub(crate) use infos::{ActionMasks, EnvInfo, Infos, TransitionInfo, repeated};
pub(crate) use native_vector_env::{
    DynVectorEnv, EnvSnapshot, VectorOptions, VectorStep, check_not_over, native_vector_env,
};
pub(crate) use observations::BatchObservation;
pub(crate) use sub_env_rng::SubEnvRng;
