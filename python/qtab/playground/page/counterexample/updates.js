// The expected updates of off-policy methods on Baird's counterexample (Sutton & Barto, 2nd ed., chapter 11), as
// qtab.prediction.expected_updates computes them. All sums run from left to right.

const STATES = 7;
const LOWER = STATES - 1;
const DISCOUNT = 0.99;
/** How often the behavior is in each state. */
const SHARE = 1 / STATES;
const INITIAL = [1, 1, 1, 1, 1, 1, 10, 1];
/** The features of each state: the values are 2 w₁ + w₈ to 2 w₆ + w₈, and w₇ + 2 w₈ in the lower state. */
const FEATURES = Array.from({ length: STATES }, (_, state) =>
  INITIAL.map((_, index) => (index === STATES ? (state === LOWER ? 2 : 1) : index !== state ? 0 : state === LOWER ? 1 : 2)),
);

const dot = (w, x) => x.reduce((sum, number, index) => sum + w[index] * number, 0);

/** The values of the states, whose true values are 0. */
export function valuesOf(w) {
  return FEATURES.map((x) => dot(w, x));
}

/** √VE: the root of the mean squared error of the values. */
export function valueError(w) {
  return Math.sqrt(valuesOf(w).reduce((sum, value) => sum + SHARE * value * value, 0));
}

/** Σ m(s) e(s) x(s), a number for each weight. */
function weighted(emphases, errors) {
  return INITIAL.map((_, index) => FEATURES.reduce((sum, x, state) => sum + emphases[state] * errors[state] * x[index], 0));
}

/** The TD errors: the target policy always leads to the lower state, and each reward is 0. */
function errorsOf(w) {
  const values = valuesOf(w);
  return values.map((value) => DISCOUNT * values[LOWER] - value);
}

const even = () => FEATURES.map(() => SHARE);

/** Each method: a function that makes updates of the weights, one at a time. */
export const METHODS = {
  /** w ← w + α Σ μ(s) δ(s) x(s) */
  td: (alpha) => (w) => {
    const moved = weighted(even(), errorsOf(w));
    return w.map((weight, index) => weight + alpha * moved[index]);
  },

  /** w ← w + α Σ μ(s) (δ(s) x(s) − γ x(s′) vᵀx(s)), v ← v + β Σ μ(s) (δ(s) − vᵀx(s)) x(s) */
  tdc: (alpha, beta) => {
    let v = INITIAL.map(() => 0);
    return (w) => {
      const errors = errorsOf(w);
      const corrections = valuesOf(v);
      const moved = weighted(even(), errors);
      const correction = corrections.reduce((sum, each) => sum + SHARE * each, 0);
      const second = weighted(even(), errors.map((error, state) => error - corrections[state]));
      v = v.map((weight, index) => weight + beta * second[index]);
      return w.map((weight, index) => weight + alpha * (moved[index] - DISCOUNT * correction * FEATURES[LOWER][index]));
    };
  },

  /** w ← w + α Σ m(s) δ(s) x(s) with the expected emphases m ← μ + γ Pᵀ m, from m = 0 */
  emphatic_td: (alpha) => {
    let emphases = FEATURES.map(() => 0);
    return (w) => {
      const followed = emphases.reduce((sum, emphasis) => sum + emphasis, 0);
      emphases = emphases.map((_, state) => (state === LOWER ? SHARE + DISCOUNT * followed : SHARE));
      const moved = weighted(emphases, errorsOf(w));
      return w.map((weight, index) => weight + alpha * moved[index]);
    };
  },
};

/** The weights before the first sweep over the states and after each one. */
export function expectedUpdates(method, sweeps, alpha, beta) {
  const update = METHODS[method](alpha, beta);
  const weights = [INITIAL];
  while (weights.length <= sweeps) weights.push(update(weights.at(-1)));
  return weights;
}
