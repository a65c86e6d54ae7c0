"""Training with the default presets of other environments than MountainCar."""

import qtab
from loops import numba_loops, plain_loop, table_loop
from qtab.config.presets import preset
from tables import Benchmark, Column, Table, relative_to

EPISODES = {"FrozenLake-v1": 400, "Taxi-v4": 40, "CartPole-v1": 100}
"""The episodes of the plain loop in a round; the schedules of the rates extend over these episodes."""
TABLES = ("FrozenLake-v1", "Taxi-v4")
"""The environments with a transition table, over which Numba's loop runs."""
PLAIN, NUMBA = "a plain loop: NumPy on gymnasium.make", "a loop over the table under numba"
TRAIN, MANY, MANY_ON_TWO = "qtab.train", "train_many, 16 seeds, one thread", "train_many, 32 seeds, two threads"


def training() -> Table:
    """Returns the table of each environment: the loops, a single run, and many runs on one and two threads."""
    loops: dict[str, Benchmark] = {}
    of_plain: dict[str, str] = {}
    of_numba: dict[str, str] = {}
    for env in EPISODES:
        short = env.partition("-")[0]
        methods = {PLAIN: _plain(env)}
        if numba_loops.numba and env in TABLES:
            methods[NUMBA] = _numba(env)
        methods |= {TRAIN: _single(env), MANY: _many(env, 16, 1), MANY_ON_TWO: _many(env, 32, 2)}
        rows = {f"{short}, {method}": loop for method, loop in methods.items()}
        of_plain |= relative_to(f"{short}, {PLAIN}", [*rows])
        of_numba |= relative_to(f"{short}, {NUMBA}", [*rows][1:])
        loops |= rows
    columns = [Column("× plain loop", of_plain), Column("× numba", of_numba)]
    return Table("Training, the environment's preset", loops, columns)


def _plain(env: str) -> Benchmark:
    return lambda index: plain_loop.q_learning(env, EPISODES[env], index)[1]


def _numba(env: str) -> Benchmark:
    arguments = table_loop.arguments(env, preset(env, None)[1]["episodes"])
    return lambda seed: int(table_loop.q_learning(*arguments(seed)))


def _single(env: str) -> Benchmark:
    return lambda index: int(qtab.train(env, seed=index, progress=False).episode_lengths.sum())


def _many(env: str, seeds: int, threads: int) -> Benchmark:
    return lambda _: int(qtab.train_many(env, seeds, threads=threads, progress=False).episode_lengths.sum())
