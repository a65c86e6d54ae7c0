//! Eligibility traces and the methods that use them (Sutton & Barto, chapter 12).

mod aligned_vec;
mod dense_traces;
mod eligibility_traces;
mod eligible_weights;
mod sarsa_lambda;
#[cfg(test)]
mod tests;
mod trace_changes;
mod trace_decay;
mod trace_pass;
mod trace_removal;
mod trace_vector;
mod true_online_sarsa_lambda;
mod watkins_q_lambda;

use eligibility_traces::{EligibilityTraces, has_traces};
pub use sarsa_lambda::SarsaLambda;
pub use trace_vector::{TraceKind, TraceOptions, Traces};
pub use true_online_sarsa_lambda::TrueOnlineSarsaLambda;
pub use watkins_q_lambda::WatkinsQLambda;
