//! The playground's engine: runs of qtab-core, requested by a page in a browser.
//!
//! A request and a response are JSON texts in the memory of the module; see [`Playground::call`]. No request can make
//! it panic: an invalid one returns the text of an error.

mod any_learner;
mod best;
mod environment;
mod episode;
pub mod exports;
mod failure;
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
