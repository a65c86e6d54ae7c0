//! A shop that orders goods every evening, and sells them the next day.
//!
//! `cargo build --release`, and then `qtab.NativeEnv("target/release/libshop.so")` in Python.

use qtab_env::{Env, Generator, Step, export_env};

/// The parameters, which do not change.
struct Shop {
    /// The most goods that fit into the shop.
    capacity: i64,
    /// The most goods in an order.
    largest_order: usize,
    price: f64,
    cost: f64,
    /// The fixed cost of a delivery.
    delivery: f64,
    /// The cost of keeping a good for a day.
    storage: f64,
}

/// The state of an episode.
#[derive(Clone, Copy)]
struct Evening {
    stock: i64,
    /// The day of the week, from 0 to 6.
    day: i64,
}

impl Env for Shop {
    type State = Evening;
    type Number = i64;

    fn num_actions(&self) -> usize {
        self.largest_order + 1
    }

    fn observation_bounds(&self) -> Vec<(i64, i64)> {
        vec![(0, self.capacity), (0, 6)]
    }

    fn max_episode_steps(&self) -> Option<u32> {
        Some(56)
    }

    fn has_action_mask(&self) -> bool {
        true
    }

    fn reset(&self, rng: &mut Generator<'_>) -> Evening {
        Evening {
            stock: rng.integers(0, self.capacity + 1),
            day: rng.integers(0, 7),
        }
    }

    fn step(&self, state: &Evening, action: usize, rng: &mut Generator<'_>) -> Step<Evening> {
        let order = action as i64;
        let customers = rng.integers(0, if state.day < 5 { 6 } else { 10 });
        let sold = customers.min(state.stock + order);
        let stock = state.stock + order - sold;
        let spent = self.cost * order as f64 + if order > 0 { self.delivery } else { 0.0 };
        let reward = self.price * sold as f64 - spent - self.storage * stock as f64;
        Step::new(
            Evening {
                stock,
                day: (state.day + 1) % 7,
            },
            reward,
            false,
        )
    }

    fn observe(&self, state: &Evening, observation: &mut [i64]) {
        observation.copy_from_slice(&[state.stock, state.day]);
    }

    /// An order must fit into the shop.
    fn action_mask(&self, state: &Evening, mask: &mut [bool]) {
        for (order, fits) in mask.iter_mut().enumerate() {
            *fits = state.stock + order as i64 <= self.capacity;
        }
    }
}

export_env!(Shop {
    capacity: 12,
    largest_order: 8,
    price: 3.0,
    cost: 1.0,
    delivery: 1.5,
    storage: 0.125
});
