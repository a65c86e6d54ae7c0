//! What is planned on: a table, and what an agent sees of its states.

use crate::envs::Env;
use crate::envs::tabular::{InvalidMdp, Outcome, TabularMdp};
use crate::envs::toy_text::{Blackjack, Hand, Taxi};

/// A table whose states an agent may not tell apart by what they show; one who remembers can.
#[derive(Clone, Debug, PartialEq)]
pub struct Mdp {
    /// All that matters is in its state.
    pub table: TabularMdp,
    /// For each state the row of an agent's table that it lights.
    pub rows: Vec<usize>,
}

impl From<TabularMdp> for Mdp {
    fn from(table: TabularMdp) -> Self {
        let rows = (0..table.states()).collect();
        Self { table, rows }
    }
}

/// The table twice: before the passenger had the occasion to change their mind, and after. Who remembers whether the
/// taxi has moved with them knows which.
impl TryFrom<&Taxi> for Mdp {
    type Error = InvalidMdp;

    fn try_from(taxi: &Taxi) -> Result<Self, InvalidMdp> {
        let Some(fickle) = taxi.fickle else { return Ok(taxi.table.clone().into()) };
        let (states, actions) = (taxi.table.states(), taxi.table.num_actions());
        let mut rows = Vec::with_capacity(2 * states * actions);
        for settled in [false, true] {
            for (state, action) in (0..states).flat_map(|state| (0..actions).map(move |action| (state, action))) {
                let mut outcomes = Vec::new();
                for (probability, step) in taxi.table.outcomes(state, action) {
                    let next = step.state as usize;
                    let place = |next: usize, probability: f64, settled: bool| {
                        outcome(probability, next + states * usize::from(settled), step.reward, step.terminated)
                    };
                    if settled || !Taxi::carries(state as u32, step.state) {
                        outcomes.push(place(next, probability, settled));
                        continue;
                    }
                    outcomes.push(place(next, probability * (1.0 - fickle), true));
                    let others = Taxi::elsewhere(step.state);
                    let share = fickle / others.len() as f64;
                    outcomes.extend(others.iter().map(|&other| place(other as usize, probability * share, true)));
                }
                rows.push(outcomes);
            }
        }
        let mut start = taxi.table.initial().to_vec();
        start.resize(2 * states, 0.0);
        let table = TabularMdp::new(actions, &start, &rows)?;
        Ok(Self { table, rows: (0..2 * states).map(|state| state % states).collect() })
    }
}

/// Gymnasium's cells, (sum, open card, usable ace), and after them the naturals, by the open card: they show what three
/// cards may show, too, and are paid otherwise.
impl TryFrom<&Blackjack> for Mdp {
    type Error = InvalidMdp;

    fn try_from(rules: &Blackjack) -> Result<Self, InvalidMdp> {
        let [sums, cards, aces] = Blackjack::OBSERVATION_SHAPE;
        let cells = sums * cards * aces;
        let cell = |hand: &Hand, shown: usize| {
            if hand.natural() {
                return cells + shown;
            }
            (hand.sum() as usize * cards + shown) * aces + usize::from(hand.usable_ace())
        };
        let dealt: Vec<Vec<(f64, Hand)>> = (0..cards).map(|shown| Blackjack::dealers_hands(shown as u32)).collect();
        let mut rows = Vec::new();
        for state in 0..cells + cards {
            let shown = if state < cells { state / aces % cards } else { state - cells };
            let hand = if state < cells {
                Hand::showing((state / aces / cards) as u32, state % aces == 1)
            } else {
                Some(Hand::default().with(1).with(10))
            };
            let Some(hand) = hand.filter(|hand| shown > 0 && !hand.bust()) else {
                // No hand shows this.
                rows.extend([0, 1].map(|_| vec![outcome(1.0, state, 0.0, true)]));
                continue;
            };
            let stick =
                |(probability, dealer): &(f64, Hand)| outcome(*probability, state, rules.payoff(&hand, dealer), true);
            rows.push(dealt[shown].iter().map(stick).collect());
            let hit = Blackjack::cards().map(|(probability, card)| {
                let hand = hand.with(card);
                if hand.bust() {
                    outcome(probability, state, -1.0, true)
                } else {
                    outcome(probability, cell(&hand, shown), 0.0, false)
                }
            });
            rows.push(hit.collect());
        }
        let mut start = vec![0.0; cells + cards];
        for (open, shown) in Blackjack::cards() {
            for (first, one) in Blackjack::cards() {
                for (second, two) in Blackjack::cards() {
                    start[cell(&Hand::default().with(one).with(two), shown as usize)] += open * first * second;
                }
            }
        }
        let shows = |state: usize| if state < cells { state } else { ((21 * cards) + state - cells) * aces + 1 };
        let seen = (0..cells + cards).map(shows).collect();
        Ok(Self { table: TabularMdp::new(rules.num_actions(), &start, &rows)?, rows: seen })
    }
}

fn outcome(probability: f64, state: usize, reward: f64, terminated: bool) -> Outcome {
    Outcome { probability, state: (state as u64).cast_signed(), reward, terminated }
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::AtomicBool;

    use super::*;
    use crate::envs::toy_text::TaxiState;
    use crate::planning::{finite_horizon, policy_return};
    use crate::random::{Pcg64, SeedSequence};

    static GO: AtomicBool = AtomicBool::new(false);

    /// The mean return of an environment under a policy over its rows, and its standard error.
    fn played<E: Env<Action = usize>>(env: &E, row: impl Fn(&E::State) -> usize, policy: &[usize]) -> (f64, f64) {
        let mut rng = Pcg64::new(&SeedSequence::new(&[1]));
        let episodes = 100_000;
        let (mut sum, mut squares) = (0.0, 0.0);
        for _ in 0..episodes {
            let (mut state, mut total) = (env.reset(&mut rng), 0.0);
            for _ in 0..50 {
                let step = env.step(state, policy[row(&state)], &mut rng);
                (state, total) = (step.state, total + step.reward);
                if step.terminated {
                    break;
                }
            }
            sum += total;
            squares += total * total;
        }
        let mean = sum / f64::from(episodes);
        (mean, ((squares / f64::from(episodes) - mean * mean) / f64::from(episodes)).sqrt())
    }

    #[test]
    fn blackjacks_table_is_its_rules() {
        for rules in
            [Blackjack { natural: false, sab: true }, Blackjack { natural: true, sab: false }, Blackjack::default()]
        {
            let process = Mdp::try_from(&rules).expect("a table");
            let best = finite_horizon(&process.table, 1.0, 50, &GO).expect("it ends");
            let row = |state: &<Blackjack as Env>::State| {
                let [sum, shown, ace] = rules.observe(state).map(|number| number as usize);
                (sum * 11 + shown) * 2 + ace
            };
            let (mean, error) = played(&rules, row, &best.policy);
            assert!((mean - best.expected_return).abs() < 4.0 * error, "{mean} ± {error}, {}", best.expected_return);
        }
    }

    #[test]
    fn a_fickle_passengers_table_is_the_taxis() {
        // Drives about in circles with the passenger, and lets them out at every second square.
        let to =
            |state: i64, reward: f64, terminated: bool| vec![Outcome { probability: 1.0, state, reward, terminated }];
        let rows: Vec<_> = (0..500_i64)
            .flat_map(|state| [to((state + 20) % 500, -1.0, false), to(state, f64::from((state % 4) as i32), true)])
            .collect();
        let table = TabularMdp::new(2, &[1.0 / 500.0; 500], &rows).expect("a table");
        let taxi = Taxi { table, fickle: Some(0.7) };
        let process = Mdp::try_from(&taxi).expect("a table");
        let policy: Vec<usize> = (0..500).map(|cell| usize::from(cell / 20 % 2 == 0)).collect();
        let everywhere: Vec<usize> = process.rows.iter().map(|&row| policy[row]).collect();
        let expected = policy_return(&process.table, &everywhere, 50, &GO).expect("it ends");
        let (mean, error) = played(&taxi, |state: &TaxiState| state.cell as usize, &policy);
        assert!((mean - expected).abs() < 4.0 * error, "{mean} ± {error}, {expected}");
        let steady = Taxi { fickle: None, ..taxi };
        assert_eq!(Mdp::try_from(&steady).map(|process| process.table), Ok(steady.table));
    }
}
