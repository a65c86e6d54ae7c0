//! The playground's engine: runs of qtab-core, requested by a page in a browser.
//!
//! A request and a response are JSON texts in the memory of the module; see [`Playground::call`]. No request can make
//! it panic: an invalid one returns the text of an error.

mod environment;
pub mod exports;
mod failure;
mod json;
mod learners;
mod map;
mod playground;
mod report;
mod runs;
mod settings;
mod updates;

#[cfg(test)]
mod tests;

pub use playground::Playground;
