//! Environments of other libraries, which export a `qtab_env` of `qtab_env.h`: libraries in C or Rust, and functions that
//! Numba has compiled.

mod capsule;
mod external_env;
mod external_task;
mod external_vector_env;
mod observations;
mod py_external_env;
mod py_external_episode;
mod repeated_episode;
mod sub_env;

pub(crate) use py_external_env::PyExternalEnv;
pub(crate) use py_external_episode::PyExternalEpisode;
