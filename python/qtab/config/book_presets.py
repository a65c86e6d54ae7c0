"""The settings of figures of Sutton & Barto's book (2nd ed.), for the environments of these figures."""

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
