// Examples: settings that fail and settings that learn, each with a sentence on what to look at.

import { make } from "./elements.js";
import { copyGrid, fit, PAINTED } from "../store.js";

const OWN_SETTINGS = "These are settings of your own. Choose an example to return to it.";

const NEVER_REACHED = "Without exploration or optimism the goal is never reached, and all values stay 0.";

/** The three examples of a lake, with the sentences on what to look at. */
function lake(unexplored, optimistic, exploring) {
  return [
    { preset: "solved", settings: { initial_q: 0 }, title: "No exploration: fails", look: unexplored },
    { preset: "solved", title: "Optimistic: solved", look: optimistic },
    { preset: "tuned", title: "Exploring with ε", look: exploring },
  ];
}

/** n-step Sarsa with a Fourier basis. */
function fourier(n_steps, order, learning_rate, settings) {
  return { algorithm: "n_step_sarsa", n_steps, discretizer: "fourier", order, learning_rate, initial_q: 0, ...settings };
}

/** An agent that balances the pole if the cosines of its four components are coupled. */
const POLE = { learning_rate_schedule: "constant", epsilon: 0.1, epsilon_schedule: "linear", discount: 0.99, episodes: 300 };

/**
 * The examples of each environment: `preset` names settings of the package, `settings` change some of them, `grid`
 * names a grid world to start from.
 */
export const EXAMPLES = {
  "MountainCar-v0": [
    {
      preset: "article",
      title: "The article: fails",
      look: "Settings of a well-known article. Until ε has fallen, nearly every episode takes all 200 steps, and the mean return stays far below the threshold: the cells are coarse, and γ = 0.9 hides a goal that is 100 steps away.",
    },
    {
      preset: "article",
      settings: { scale: [20, 200], discount: 1, initial_q: 0, epsilon: 0, learning_rate: 0.5, learning_rate_schedule: "linear" },
      title: "Optimistic: better",
      look: "Still Q-learning on a grid, now with γ = 1, smaller cells, a falling α, and initial values of 0. As each step costs 1, these are optimistic: the agent explores without ε. It begins to reach the flag after a few hundred episodes and ends well above the article, but the threshold stays out of reach.",
    },
    {
      preset: "solved",
      title: "Solved: tile coding",
      look: "True online Sarsa(λ) with 32 tilings. The curve passes the threshold within a few hundred episodes, and the values form a smooth spiral: the path swings out and climbs to the flag.",
    },
    {
      preset: "solved",
      settings: fourier(16, 5, 0.003, { learning_rate_schedule: "linear", episodes: 500 }),
      title: "Fourier basis",
      look: "n-step Sarsa with 36 cosines for each action: 108 weights, where the tiles have 7,776. The map is a smooth surface from the first episodes on, and the first 100 episodes take about 160 steps on average over 16 seeds. But each update moves the values of all states, and the last 100 still take about 130.",
    },
  ],
  "CartPole-v1": [
    {
      preset: "tuned",
      settings: { bins: [1, 1, 2, 1] },
      title: "Too coarse: fails",
      look: "The agent sees only to which side the pole leans, not how fast it falls. No table with two states can balance the pole, however long it learns.",
    },
    {
      preset: "tuned",
      title: "Bins",
      look: "The map shows pole angle and angular velocity with the cart at rest in the middle. The border between the two pushes is what the agent has learned.",
    },
    {
      preset: "solved",
      title: "Solved: tile coding",
      look: "True online Sarsa(λ) with 16 tilings. The curve rises to 500, the time limit, and the greedy agent keeps the pole up to the end.",
    },
    {
      preset: "solved",
      settings: fourier(8, 2, 0.005, POLE),
      title: "Fourier basis: solved",
      look: "n-step Sarsa with 81 cosines for each action, of all four components together. It learns in a few dozen episodes: the first 100 already last about 275 steps on average over 16 seeds, and from the 200th on every episode of every seed lasts 500.",
    },
    {
      preset: "solved",
      settings: fourier(8, 2, 0.05, { ...POLE, coupled: false }),
      title: "Uncoupled: fails",
      look: "Only the 9 cosines of single components: a value is a sum of functions of single components. But what an angle is worth depends on how fast it changes, and no such sum says that. Even with an α ten times as large, which is good here, the pole falls after about 65 steps on average over 16 seeds.",
    },
  ],
  "Acrobot-v1": [
    {
      preset: "learns",
      title: "Tile coding",
      look: "True online Sarsa(λ) with 16 tilings. The first swing-ups take hundreds of steps, those after 200 episodes about a hundred, and the last ones fewer than 90 on average over 16 seeds. On the map both links are at rest; an arrow to the left is a torque of −1, one to the right a torque of +1.",
    },
    {
      preset: "learns",
      settings: { algorithm: "sarsa" },
      title: "One-step Sarsa: slower",
      look: "The same tiles without traces: each update changes the value of a single step, and what is learned at the line spreads back slowly. Over 16 seeds, the first 100 episodes take about 40 steps more on average, and the last 100 about 10 more.",
    },
    {
      preset: "learns",
      settings: { algorithm: "q_learning", discretizer: "bins", bins: [4, 4, 4, 4, 4, 4], learning_rate: 0.5 },
      title: "Bins: slow",
      look: "4 bins for each of the six components make 4,096 states, and none of them learns from its neighbors: after 1,000 episodes a swing-up still takes about 300 steps on average over 16 seeds. With 2, 2, 2, 2, 4 and 4 bins there are only 256 states, and it takes about half as many.",
    },
    {
      preset: "learns",
      settings: fourier(16, 3, 0.005, { coupled: false, learning_rate_schedule: "linear", episodes: 300 }),
      title: "Fourier basis",
      look: "n-step Sarsa with 19 cosines for each action, of single components: 57 weights, where the tiles have hundreds of thousands. A swing-up takes about 110 steps in the first 100 episodes and about 90 after them, on average over 16 seeds. The observations already are sines and cosines of the angles, so a few waves over them are enough.",
    },
  ],
  "FrozenLake-v1": lake(
    "With ε = 0 and initial values of 0 all actions look alike, and the agent always takes the first. It never sees the goal, so there is nothing to learn from: all values stay 0.",
    "The only change: initial values of 1. Every action that has been tried looks worse than the untried ones, so the agent tries everything. It then reaches the goal in about three out of four episodes, as often as an optimal policy does. On slippery ice both sometimes fall into a hole: with seed 0, the greedy agent shown below does.",
    "Here ε falls from 1 to 0. Returns stay low while the agent explores, and rise at the end; halfway through, the greedy agent was already as good.",
  ),
  "FrozenLake-v1 (not slippery)": lake(
    "All values are 0, and the agent pushes against the left edge in every step. Without exploration or optimism it never learns that there is a goal.",
    "With initial values of 1 the agent tries everything. Without slipping, the values fall by γ with each step from the goal.",
    "All values stay 0 until an episode reaches the goal. From then on they spread backwards from it: a state has a value once a state after it has one.",
  ),
  "FrozenLake8x8-v1": lake(
    NEVER_REACHED,
    "Beside a hole most arrows point straight away from it rather than to the goal: on slippery ice this is the only move that cannot end in the hole.",
    "The larger the lake, the longer it takes until chance finds the goal: several hundred episodes, compared with about a hundred on the small lake. Look at the visits.",
  ),
  "FrozenLake8x8-v1 (not slippery)": lake(
    NEVER_REACHED,
    "The agent tries nearly everything, then takes a shortest path around the holes.",
    "Nearly half of the visits fall on the ten cells nearest to the start: a random walk rarely gets far.",
  ),
  "CliffWalking-v1": [
    {
      preset: "book",
      title: "Q-learning on the edge",
      look: "Example 6.6 of Sutton & Barto. Q-learning learns the shortest path, along the edge; but while it explores, it falls in about one in four episodes. Compare its mean return with Sarsa's, over 16 seeds.",
    },
    {
      preset: "book",
      settings: { algorithm: "sarsa" },
      title: "Sarsa keeps away",
      look: "Sarsa learns the values of the policy that it follows, exploration included, and so keeps away from the edge: its greedy path is longer, but it falls less often. In the last 100 episodes its mean return over 16 seeds is about −26, compared with −47 for Q-learning. A few episodes of a single seed can show the opposite.",
    },
    {
      preset: "solved",
      title: "Solved",
      look: "Nothing here is random, so α = 1 and no exploration are enough: the greedy path takes 13 steps.",
    },
    { preset: "tuned", title: "ε falls to 0", look: "As ε falls, falls from the cliff become rare, and the return of most episodes reaches the optimum of −13." },
  ],
  "Taxi-v4": [
    {
      preset: "tuned",
      title: "ε falls to 0",
      look: "Ordinary Q-learning. At first, pick-ups and drop-offs at wrong places make a ride cost hundreds; after about 500 rides it begins to earn, and in the end nearly as much as an optimal driver earns. On the map, P and D stand for pick up and drop off.",
    },
    {
      preset: "solved",
      settings: { episodes: 5000 },
      title: "Optimistic: solved",
      look: "Initial values of 20, more than any ride can earn: whatever has been tried looks worse than what has not, so the agent tries everything without ε. After half as many rides the greedy agent drives every ride at the least cost.",
    },
  ],
  "Blackjack-v1": [
    {
      preset: "learns",
      title: "ε falls to 0",
      look: "H is hit and S is stick: the agent learns to stick at high sums, and with a usable ace, which cannot make it go over, at higher ones. Returns of single games are +1, 0 or −1: only their mean shows what is learned, and even the best player loses a little on average.",
    },
    {
      preset: "learns",
      settings: { episodes: 1000 },
      title: "Too few games: luck",
      look: "After 1,000 games each state has been seen a few times at most, and luck decides on the action: with a usable ace there is no clear border between H and S, and the greedy agent loses more.",
    },
  ],
  WindyGridWorld: [
    {
      preset: "learns",
      settings: { algorithm: "sarsa" },
      title: "Sarsa",
      look: "Example 6.5 of Sutton & Barto. The wind carries the agent to the top row and past the goal; it goes down in the calm column on the right, and returns from there.",
    },
    { preset: "learns", title: "Q-learning", look: "The values fall by 1 with each step from the goal, and the greedy path takes 15 steps." },
    {
      preset: "learns",
      settings: { exploration: "softmax", temperature: 5 },
      title: "Too random: slow",
      look: "With a high temperature all actions are nearly equally likely. Q-learning learns the shortest path all the same, of 15 steps, but its own returns stay low.",
    },
  ],
  grid: [
    {
      preset: "learns",
      grid: "Open field",
      title: "Open field",
      look: "Choose Wall above the maps and draw a barrier between start and goal: the agent finds another way at once.",
    },
    {
      preset: "learns",
      grid: "Dyna maze",
      settings: { discount: 0.95, learning_rate: 0.1, episodes: 30, ties: "random" },
      title: "Maze, Q-learning",
      look: "Example 8.1 of Sutton & Barto. Without planning, each episode carries the values only a little further back from the goal. Compare the steps of an episode with those of Dyna-Q.",
    },
    {
      preset: "learns",
      grid: "Dyna maze",
      settings: { algorithm: "dyna_q", planning_steps: 50, discount: 0.95, learning_rate: 0.1, episodes: 30, ties: "random" },
      title: "Maze, Dyna-Q",
      look: "The same 30 episodes, with 50 updates from a learned model after each step: after a few episodes most of the maze has values, and an episode takes few steps.",
    },
    {
      preset: "learns",
      grid: "Four rooms",
      title: "Four rooms",
      look: "The doors are bottlenecks. Paint a wall into one, or a negative reward, and the path goes through the other.",
    },
  ],
};

/** The state of an example. */
export function exampleState(store, environment, index) {
  const { preset, settings, grid } = EXAMPLES[environment][index];
  const state = store.initial(environment, preset);
  const entry = store.definitions.environments[environment];
  if (grid) state.grid = copyGrid(entry.grids[grid]);
  return { ...state, settings: fit(store.definitions, environment, { ...state.settings, ...settings }), seed: store.state.seed, seeds: store.state.seeds };
}

/** What two states must share to be the same example. One number of tiles or bins means the same as a list of it. */
function identity({ definitions }, { environment, settings, grid }) {
  const plain = (name, value) => {
    const ofComponents = ["integers", "numbers"].includes(definitions.settings[name].type) && Array.isArray(value);
    return ofComponents && value.every((each) => each === value[0]) ? value[0] : value;
  };
  const values = Object.keys(settings).sort().map((name) => [name, plain(name, settings[name])]);
  return JSON.stringify([values, environment === PAINTED ? grid : null]);
}

const identities = new Map(); // of the examples of each environment

/** The index of the example whose settings a store has, however it came to have them; null if they are the reader's own. */
export function exampleOf(store) {
  const { environment } = store.state;
  if (!identities.has(environment)) {
    identities.set(environment, EXAMPLES[environment].map((_, index) => identity(store, exampleState(store, environment, index))));
  }
  const index = identities.get(environment).indexOf(identity(store, store.state));
  return index < 0 ? null : index;
}

/** Shows the examples of the environment as buttons, and the sentence of the chosen one. */
export function setUpExamples(store, buttons, look) {
  const show = ({ environment }) => {
    const example = exampleOf(store);
    const examples = EXAMPLES[environment];
    if (buttons.dataset.environment !== environment) {
      buttons.dataset.environment = environment;
      const onclick = (index) => () => store.update(exampleState(store, environment, index));
      const made = examples.map(({ title }, index) => make("button", { type: "button", textContent: title, onclick: onclick(index) }));
      buttons.replaceChildren(...made);
    }
    [...buttons.children].forEach((button, index) => button.setAttribute("aria-pressed", index === example));
    const chosen = examples[example]?.look ?? OWN_SETTINGS;
    if (look.textContent !== chosen) look.textContent = chosen;
  };
  store.subscribe(show);
  show(store.state);
}
