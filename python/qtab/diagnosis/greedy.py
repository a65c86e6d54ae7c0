"""The greedy policy: episodes played with it, and the finding that it repeats states until the time limit."""

from contextlib import AbstractContextManager, closing, nullcontext
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import gymnasium as gym
import numpy as np
from numpy.typing import NDArray

from qtab._utils.shown import counted, last_of
from qtab.diagnosis.finding import Finding, Share, Unchecked, changes, percent
from qtab.envs.actions import flat
from qtab.envs.registry import UNLIMITED_MAX_EPISODE_STEPS
from qtab.results.run import Run
from qtab.results.words import Names
from qtab.training.setup.run_env import make_run_env

if TYPE_CHECKING:
    from qtab.diagnosis.facts import Facts

EPISODES = 20
MOST_STEPS = 20_000
"""The largest number of steps to play, which takes a fraction of a second in most environments."""
LEAST_STEPS = 8
LEAST_VISITS = 4
"""States repeat if each one is visited so often, on average, in the second half of an episode."""
LAST_EPISODES, LEAST_EPISODES = 100, 10
STANDARD_ERRORS = 3.0
SHOWN = 2


@dataclass(frozen=True)
class GreedyEpisodes:
    """Episodes of a run's greedy policy."""

    returns: NDArray[np.float64]
    """(episodes,): the sum of rewards of each episode."""
    repeated: NDArray[np.int64]
    """(episodes,): the number of different states in the second half of an episode that runs into the time limit and
    repeats states; 0 for other episodes."""
    states: tuple[str, ...]
    """A few of the states that the first of these episodes repeats, in words."""

    @property
    def repeats(self) -> NDArray[np.bool_]:
        """(episodes,): whether the episode repeats states until the time limit."""
        return self.repeated > 0


def play_greedily(run: Run, env: gym.Env | None) -> GreedyEpisodes | None:
    """Plays up to 20 episodes with the greedy policy of a run, and at most about as many steps as its training had.

    Args:
        run: The run.
        env: Its environment, which is reset and stepped, and not closed; None makes it again.

    Returns:
        The episodes; None if the first one would take too many steps.
    """
    most = min(MOST_STEPS, int(run.episode_lengths.sum()))
    opened: AbstractContextManager[gym.Env] = closing(make_run_env(run.config)) if env is None else nullcontext(env)
    returns: list[float] = []
    repeated: list[int] = []
    states: tuple[str, ...] = ()
    steps = 0
    with opened as made:
        while len(returns) < EPISODES and steps < most:
            total, length, seen = _episode(run, made, len(returns), most - steps)
            steps += length
            if total is None:
                break
            returns.append(total)
            repeated.append(len(seen))
            if seen and not states:
                names = Names.of(run, made)
                found = [names.state(observation) for observation in list(seen.values())[:SHOWN]]
                states = tuple(f"state {state}" if state.startswith("(") else state for state in found)
    return GreedyEpisodes(np.array(returns), np.array(repeated, np.int64), states) if returns else None


def _episode(run: Run, env: gym.Env, seed: int, most: int) -> tuple[float | None, int, dict[Any, Any]]:
    """Plays one episode of at most ``most`` steps.

    Returns:
        The return, None if the episode did not end; its number of steps; and the different observations of its second
        half if it ran into the time limit and repeats them, else none.
    """
    limit = run.config.max_episode_steps or UNLIMITED_MAX_EPISODE_STEPS
    second_half = limit - limit // 2
    seen: dict[Any, Any] = {}
    observation, _ = env.reset(seed=seed)
    state, total = None, 0.0
    for step in range(min(limit, most)):
        if step >= limit // 2 and len(seen) * LEAST_VISITS <= second_half:
            seen.setdefault(tuple(flat(observation)), observation)
        action, state = run.predict(observation, state)
        observation, reward, terminated, truncated, _ = env.step(action)
        total += float(reward)
        if terminated or truncated or step + 1 == limit:
            repeats = step + 1 == limit and not terminated and second_half >= LEAST_STEPS
            return total, step + 1, seen if repeats and len(seen) * LEAST_VISITS <= second_half else {}
    return None, most, {}


def greedy_loop(facts: "Facts") -> Finding | Unchecked | None:
    """Finds that the greedy policy repeats states until the time limit, and returns clearly less than training."""
    played = facts.greedy
    if played is None:
        return Unchecked(facts.why_not_played)
    run = facts.run
    if not run.terminated.any():
        return Unchecked("no training episode ended before the time limit")
    last = run.episode_returns[-LAST_EPISODES:]
    if len(last) < LEAST_EPISODES:
        return Unchecked("there are too few episodes")
    returns = played.returns
    error = float(np.sqrt(last.var() / len(last) + returns.var() / len(returns)))
    if not played.repeats.any() or returns.mean() >= last.mean() - STANDARD_ERRORS * error:
        return None
    share = float(played.repeats.mean())
    states = int(np.median(played.repeated[played.repeats]))
    more = 5 * facts.config.episodes
    where = " and ".join(played.states)  # of one episode; others may repeat other states
    return Finding(
        title="The greedy policy repeats states until the time limit.",
        evidence={
            "greedy policy": float(returns.mean()),
            last_of(len(last), "training episode"): float(last.mean()),
            "share of greedy episodes that repeat states": Share(share),
            "time limit": run.config.max_episode_steps or UNLIMITED_MAX_EPISODE_STEPS,
        },
        meaning=f"{percent(share)} of {counted(len(returns), 'greedy episode')} visit only {counted(states, 'state')} "
        f"in their second half, for example {where}. In training, exploration leaves such a loop; the greedy policy "
        "never does.",
        advice=f"train longer, such as episodes={more}, until the values of these states have settled",
        changes=changes(facts.config, {"episodes": more}),
    )
