//! Policy gradient methods (Sutton & Barto, chapter 13).

mod actor_critic;
mod actor_critic_lambda;
mod critic;
mod gradient;
mod reinforce;

pub use actor_critic::ActorCritic;
pub use actor_critic_lambda::ActorCriticLambda;
pub use critic::Critic;
pub use reinforce::Reinforce;
