//! Policies choose an action by its value.

mod any_policy;
mod epsilon_greedy;
mod greedy_policy;
mod policy;
mod softmax;
mod tie_breaking;
mod ucb;

pub use any_policy::AnyPolicy;
pub(crate) use any_policy::random_available_action;
pub use epsilon_greedy::EpsilonGreedy;
pub use greedy_policy::GreedyPolicy;
pub use policy::Policy;
pub use softmax::Softmax;
pub use tie_breaking::TieBreaking;
pub use ucb::Ucb;

/// The sum from left to right, starting with the first number, so that its bits do not depend on the machine.
/// (`np.sum` adds pairwise and would round differently.)
#[inline]
fn sum(mut numbers: impl Iterator<Item = f64>) -> f64 {
    let first = numbers.next().unwrap_or(0.0);
    numbers.fold(first, |total, number| total + number)
}
