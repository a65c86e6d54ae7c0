"""Settings of tile coding that solve tasks of classic control."""

from qtab.config.settings import SharedSettings

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
