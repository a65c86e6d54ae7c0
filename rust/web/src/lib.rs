//! The playground's engine: runs of qtab-core that a page in a browser asks for.
//!
//! A request and a response are JSON texts in the memory of the module; see [`Playground::call`]. Nothing that a page can
//! send panics: what is wrong with a request is the text of an error.

mod any_learner;
mod best;
mod environment;
mod episode;
pub mod exports;
mod grid_world;
mod json;
mod memory;
mod plane;
mod playground;
mod report;
mod run;
mod settings;
mod step_terms;
mod subject;
mod training;
mod update_recorder;
mod updates;

#[cfg(test)]
mod tests;

pub use playground::Playground;
