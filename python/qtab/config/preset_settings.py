"""The settings of presets: those of figures of Sutton & Barto's book (2nd ed.), and of tile coding."""

import math

import numpy as np

from qtab.config.settings import SharedSettings

# Example 6.6.
CLIFF_WALKING: SharedSettings = {
    "learning_rate": 0.5,
    "discount": 1.0,
    "epsilon": 0.1,
    "epsilon_schedule": "constant",
    "initial_q": 0.0,
    "episodes": 500,
}

# Figure 6.5. State A has two actions; -inf marks missing ones.
MAXIMIZATION_BIAS: SharedSettings = {
    "learning_rate": 0.1,
    "discount": 1.0,
    "epsilon": 0.1,
    "epsilon_schedule": "constant",
    "ties": "random",
    "initial_q": np.array([[0.0] * 2 + [-np.inf] * 8, [0.0] * 10, [0.0] * 10]),
    "episodes": 300,
}

# Figure 2.2: sample averages and an exploration rate of 0.1.
K_ARMED_BANDIT: SharedSettings = {
    "learning_rate": 1.0,
    "learning_rate_schedule": "visits",
    "discount": 1.0,
    "epsilon": 0.1,
    "epsilon_schedule": "constant",
    "ties": "random",
    "initial_q": 0.0,
    "episodes": 1000,
}

# Figure 13.1. The initial policy goes right with probability 0.05, as the figure's first returns show; the book does
# not state it.
SHORT_CORRIDOR: SharedSettings = {
    "algorithm": "reinforce",
    "learning_rate": 2.0**-13,
    "discount": 1.0,
    "initial_q": np.array([[math.log(19.0), 0.0]]),
    "episodes": 1000,
}

# Figure 8.2, with 50 planning steps.
DYNA_MAZE: SharedSettings = {
    "algorithm": "dyna_q",
    "planning_steps": 50,
    "learning_rate": 0.1,
    "discount": 0.95,
    "epsilon": 0.1,
    "epsilon_schedule": "constant",
    "ties": "random",
    "initial_q": 0.0,
    "episodes": 50,
}

# Figures 8.4 and 8.5: Dyna-Q+ for 3,000 and for 6,000 steps. The book states no settings; docs/book/chapter_8.md
# explains how these were chosen.
CHANGING_MAZE: SharedSettings = {
    **DYNA_MAZE,
    "algorithm": "dyna_q_plus",
    "time_weight": 1e-3,
    "learning_rate": 0.5,
}
BLOCKING_MAZE: SharedSettings = {**CHANGING_MAZE, "episodes": 300}
SHORTCUT_MAZE: SharedSettings = {**CHANGING_MAZE, "episodes": 600}

# Figure 10.5. In the book its 2,000,000 steps are one episode, as the task never ends; here they are 200, so that there
# are returns to plot.
ACCESS_CONTROL_QUEUE: SharedSettings = {
    "algorithm": "differential_sarsa",
    "learning_rate": 0.01,
    "reward_learning_rate": 0.01,
    "discount": 1.0,
    "epsilon": 0.1,
    "epsilon_schedule": "constant",
    "ties": "random",
    "initial_q": 0.0,
    "max_episode_steps": 10_000,
    "episodes": 200,
}


# Sarsa(λ) on tile coding, as in Sutton & Barto, Example 10.1 and Figure 12.10. It needs no exploration rate: values of
# 0 are optimistic if every step costs 1.
_TILES: SharedSettings = {
    "algorithm": "sarsa_lambda",
    "discretizer": "tiles",
    "tilings": 8,
    "tiles": (16,),
    "learning_rate": 0.5,
    "learning_rate_schedule": "linear",
    "discount": 1.0,
    "epsilon": 0.0,
    "trace_decay": 0.9,
    "trace_cutoff": 1e-3,
    "initial_q": 0.0,
    "episodes": 2000,
}
# Chosen on the seeds 20,000 to 20,199; docs/reference/environments.md reports results on others.
SOLVED_MOUNTAIN_CAR: SharedSettings = {
    **_TILES,
    "algorithm": "true_online_sarsa_lambda",
    "tilings": 32,
    "tiles": (8,),
    "learning_rate": 1.5,
    "trace_decay": 0.85,
    "episodes": 2000,
}
# Pushing costs energy: with initial values below 100 (12.5 in each tiling) the car learns to stand still.
CONTINUOUS_MOUNTAIN_CAR: SharedSettings = {
    **_TILES,
    "actions": (-0.3, 0.3),
    "learning_rate": 0.2,
    "epsilon": 0.1,
    "epsilon_schedule": "linear",
    "initial_q": 12.5,
    "episodes": 500,
}

# Chosen on a part of the seeds 20,000 to 20,199; docs/reference/environments.md reports results on others.
_TRACES: SharedSettings = {
    **_TILES,
    "algorithm": "true_online_sarsa_lambda",
    "trace_decay": 0.8,
    "epsilon": 0.1,
    "epsilon_schedule": "linear",
}
# While the learning rate is high, the policy now and then loses a rare state near the edge for some episodes. An
# exponential schedule ends with hundreds of episodes in which the learning rate hardly changes. Chosen on the seeds
# 20,100 to 20,499.
SOLVED_CART_POLE: SharedSettings = {
    **_TRACES,
    "tilings": 16,
    "tiles": (8,),
    "learning_rate": 1.0,
    "learning_rate_schedule": "exponential",
    "learning_rate_decay": 0.997,
    "trace_cutoff": 1e-2,
    "low": (-2.4, -2.5, -0.21, -3.5),
    "high": (2.4, 2.5, 0.21, 3.5),
    "discount": 0.999,
    "episodes": 3000,
}
ACROBOT: SharedSettings = {
    **_TRACES,
    "tilings": 32,
    "tiles": (4, 4, 4, 4, 5, 5),
    "learning_rate": 1.0,
    "epsilon": 0.0,
    "episodes": 3000,
}
PENDULUM: SharedSettings = {
    **_TRACES,
    "actions": 3,
    "tilings": 32,
    "tiles": (6,),
    "discount": 0.98,
    "episodes": 2000,
}

# The limits cover the usual states; the bounds of the space are wider. Chosen on the seeds 20,000 and 20,001.
LUNAR_LANDER: SharedSettings = {
    **_TRACES,
    "tilings": 32,
    "tiles": (4, 4, 4, 4, 4, 4, 1, 1),
    "hashed_rows": 2**20,
    "low": (-0.8, -0.2, -1.0, -1.4, -0.8, -1.2, 0.0, 0.0),
    "high": (0.8, 1.5, 1.0, 0.4, 0.8, 1.2, 1.0, 1.0),
    "discount": 0.99,
    "epsilon": 0.0,
    "trace_cutoff": 1e-2,
    "episodes": 3000,
}
