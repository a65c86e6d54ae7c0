//! Environments as Markov decision processes for planning.

use crate::envs::Env;
use crate::envs::tabular::{InvalidMdp, Outcome, TabularMdp};
use crate::envs::toy_text::{Blackjack, Hand, Taxi};

/// A Markov decision process with its observations. Its states include everything that the dynamics depend on, so
/// several states can look the same to an agent.
#[derive(Clone, Debug, PartialEq)]
pub struct Mdp {
    /// The transition table.
    pub table: TabularMdp,
    /// For each state, the row of the agent's Q table that its observation activates.
    pub rows: Vec<usize>,
}

/// Every state is its own observation.
impl From<TabularMdp> for Mdp {
    fn from(table: TabularMdp) -> Self {
        let rows = (0..table.num_states()).collect();
        Self { table, rows }
    }
}

/// With fickle passengers the table is doubled: first the states in which the passenger may still change the
/// destination, then those after the taxi has moved with them. An agent that remembers this move can tell the two
/// apart.
impl TryFrom<&Taxi> for Mdp {
    type Error = InvalidMdp;

    fn try_from(taxi: &Taxi) -> Result<Self, InvalidMdp> {
        let Some(fickle) = taxi.fickle else { return Ok(taxi.table.clone().into()) };
        let (num_states, num_actions) = (taxi.table.num_states(), taxi.table.num_actions());
        let mut pairs = Vec::with_capacity(2 * num_states * num_actions);
        for decided in [false, true] {
            for pair in 0..num_states * num_actions {
                let (state, action) = (pair / num_actions, pair % num_actions);
                let mut outcomes = Vec::new();
                for (probability, step) in taxi.table.outcomes(state, action) {
                    let next = step.state as usize;
                    let outcome_at = |next: usize, probability: f64, decided: bool| {
                        outcome(probability, next + num_states * usize::from(decided), step.reward, step.terminated)
                    };
                    if decided || !Taxi::moves_passenger(state as u32, step.state) {
                        outcomes.push(outcome_at(next, probability, decided));
                        continue;
                    }
                    outcomes.push(outcome_at(next, probability * (1.0 - fickle), true));
                    let others = Taxi::with_other_destinations(step.state);
                    let share = fickle / others.len() as f64;
                    outcomes.extend(others.iter().map(|&other| outcome_at(other as usize, probability * share, true)));
                }
                pairs.push(outcomes);
            }
        }
        let mut initial_distribution = taxi.table.initial_distribution().to_vec();
        initial_distribution.resize(2 * num_states, 0.0);
        let table = TabularMdp::new(num_actions, &initial_distribution, &pairs)?;
        Ok(Self { table, rows: (0..2 * num_states).map(|state| state % num_states).collect() })
    }
}

/// The states are Gymnasium's observations (player's sum, dealer's card, usable ace), followed by the naturals, one for
/// each card of the dealer. A natural looks like a 21 of three cards but pays differently.
impl TryFrom<&Blackjack> for Mdp {
    type Error = InvalidMdp;

    fn try_from(rules: &Blackjack) -> Result<Self, InvalidMdp> {
        let [num_sums, num_cards, num_aces] = Blackjack::OBSERVATION_SHAPE;
        let num_observations = num_sums * num_cards * num_aces;
        let num_states = num_observations + num_cards;
        let state_of = |hand: &Hand, shown: usize| {
            if hand.is_natural() {
                return num_observations + shown;
            }
            (hand.sum() as usize * num_cards + shown) * num_aces + usize::from(hand.usable_ace())
        };
        let dealer_hands: Vec<Vec<(f64, Hand)>> =
            (0..num_cards).map(|shown| Blackjack::dealer_hands(shown as u32)).collect();
        let mut pairs = Vec::new();
        for state in 0..num_states {
            let is_natural = state >= num_observations;
            let shown = if is_natural { state - num_observations } else { state / num_aces % num_cards };
            let hand = if is_natural {
                Some(Hand::default().with(1).with(10))
            } else {
                Hand::showing((state / num_aces / num_cards) as u32, state % num_aces == 1)
            };
            let Some(hand) = hand.filter(|hand| shown > 0 && !hand.is_bust()) else {
                // An observation that never occurs.
                pairs.extend([0, 1].map(|_| vec![outcome(1.0, state, 0.0, true)]));
                continue;
            };
            let stick =
                |(probability, dealer): &(f64, Hand)| outcome(*probability, state, rules.payoff(&hand, dealer), true);
            pairs.push(dealer_hands[shown].iter().map(stick).collect());
            let hit = Blackjack::cards().map(|(probability, card)| {
                let hand = hand.with(card);
                if hand.is_bust() {
                    outcome(probability, state, -1.0, true)
                } else {
                    outcome(probability, state_of(&hand, shown), 0.0, false)
                }
            });
            pairs.push(hit.collect());
        }
        let mut initial_distribution = vec![0.0; num_states];
        for (shown_probability, shown) in Blackjack::cards() {
            for (first_probability, first) in Blackjack::cards() {
                for (second_probability, second) in Blackjack::cards() {
                    let hand = Hand::default().with(first).with(second);
                    initial_distribution[state_of(&hand, shown as usize)] +=
                        shown_probability * first_probability * second_probability;
                }
            }
        }
        let row_of = |state: usize| {
            if state < num_observations { state } else { (21 * num_cards + state - num_observations) * num_aces + 1 }
        };
        let table = TabularMdp::new(rules.num_actions(), &initial_distribution, &pairs)?;
        Ok(Self { table, rows: (0..num_states).map(row_of).collect() })
    }
}

fn outcome(probability: f64, state: usize, reward: f64, terminated: bool) -> Outcome {
    Outcome { probability, state: (state as u64).cast_signed(), reward, terminated }
}

#[cfg(test)]
mod tests {
    use crate::StopFlag;

    use super::*;
    use crate::envs::toy_text::TaxiState;
    use crate::planning::{finite_horizon, policy_return};
    use crate::random::{Pcg64, SeedSequence};

    static NO_STOP: StopFlag<'static> = StopFlag::new();

    /// The mean return of a policy over the rows of a Q table, with its standard error, from simulated episodes.
    fn simulated_return<E: Env<Action = usize>>(
        env: &E,
        row: impl Fn(&E::State) -> usize,
        policy: &[usize],
    ) -> (f64, f64) {
        let mut rng = Pcg64::new(&SeedSequence::new(&[1]));
        let episodes = 100_000;
        let (mut sum, mut squares) = (0.0, 0.0);
        for _ in 0..episodes {
            let (mut state, mut episode_return) = (env.reset(&mut rng), 0.0);
            for _ in 0..50 {
                let step = env.step(state, policy[row(&state)], &mut rng);
                (state, episode_return) = (step.state, episode_return + step.reward);
                if step.terminated {
                    break;
                }
            }
            sum += episode_return;
            squares += episode_return * episode_return;
        }
        let mean = sum / f64::from(episodes);
        (mean, ((squares / f64::from(episodes) - mean * mean) / f64::from(episodes)).sqrt())
    }

    #[test]
    fn the_mdp_of_blackjack_has_the_returns_of_the_environment() {
        for rules in
            [Blackjack { natural: false, sab: true }, Blackjack { natural: true, sab: false }, Blackjack::default()]
        {
            let mdp = Mdp::try_from(&rules).expect("a valid table");
            let best = finite_horizon(&mdp.table, 1.0, 50, &NO_STOP).expect("not stopped");
            let row = |state: &<Blackjack as Env>::State| {
                let [sum, shown, ace] = rules.observe(state).map(|number| number as usize);
                (sum * 11 + shown) * 2 + ace
            };
            let (mean, error) = simulated_return(&rules, row, &best.policy);
            assert!((mean - best.expected_return).abs() < 4.0 * error, "{mean} ± {error}, {}", best.expected_return);
        }
    }

    #[test]
    fn the_mdp_of_a_fickle_taxi_has_the_returns_of_the_environment() {
        // A taxi that drives in a circle with its passenger, under a policy that drops them off on every second square.
        let to =
            |state: i64, reward: f64, terminated: bool| vec![Outcome { probability: 1.0, state, reward, terminated }];
        let rows: Vec<_> = (0..500_i64)
            .flat_map(|state| [to((state + 20) % 500, -1.0, false), to(state, f64::from((state % 4) as i32), true)])
            .collect();
        let table = TabularMdp::new(2, &[1.0 / 500.0; 500], &rows).expect("a valid table");
        let taxi = Taxi { table, fickle: Some(0.7) };
        let mdp = Mdp::try_from(&taxi).expect("a valid table");
        let policy: Vec<usize> = (0..500).map(|cell| usize::from(cell / 20 % 2 == 0)).collect();
        let by_state: Vec<usize> = mdp.rows.iter().map(|&row| policy[row]).collect();
        let expected = policy_return(&mdp.table, &by_state, 50, &NO_STOP).expect("not stopped");
        let (mean, error) = simulated_return(&taxi, |state: &TaxiState| state.cell as usize, &policy);
        assert!((mean - expected).abs() < 4.0 * error, "{mean} ± {error}, {expected}");
        let steady = Taxi { fickle: None, ..taxi };
        assert_eq!(Mdp::try_from(&steady).map(|mdp| mdp.table), Ok(steady.table));
    }
}
