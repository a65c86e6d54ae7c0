"""What Gymnasium's own tests ask of every environment, asked of every id of ours.

The wheel of Gymnasium ships no tests, so these are written anew; ``CLAIMS`` is their list.
"""

import copy
import pickle
import warnings
from collections.abc import Callable
from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from gymnasium import wrappers
from gymnasium.envs.registration import EnvSpec
from gymnasium.utils import passive_env_checker
from gymnasium.utils.env_checker import data_equivalence
from gymnasium.utils.env_match import check_environments_match
from gymnasium.vector import SyncVectorEnv

from qtab.envs.book.k_armed_bandit import KArmedBanditEnv
from qtab.envs.registry import EXTRA, gymnasium_id

IDS = sorted(name for name in gym.registry if name.startswith("qtab/"))
TWINS = [name for name in IDS if name not in EXTRA]
"""The ids of which Gymnasium has the original."""

pytestmark = [
    pytest.mark.filterwarnings("ignore:.*CartPole-v0 is out of date"),
    # Gymnasium's checkers recommend other spaces than Gymnasium's own environments have.
    pytest.mark.filterwarnings("ignore:.*(action|observation) space|.*maximum value|.*minimum value"),
]


def make(name: str, **kwargs: Any) -> gym.Env:
    """Makes an environment; the only one with millions of transitions, which take a second, with fewer of them."""
    smaller: dict[str, Any] = {"cars": 4} if "JacksCarRental" in name else {}
    return gym.make(name, **smaller, **kwargs)


def walk(env: gym.Env, steps: int = 25, seed: int | None = 7) -> list[Any]:
    """What random actions lead to; episodes that end are reset."""
    results: list[Any] = [env.reset(seed=seed)] if seed is not None else []
    rng = np.random.default_rng(0)
    space: Any = env.action_space
    for _ in range(steps):
        if isinstance(space, gym.spaces.Discrete):
            action: Any = np.int64(space.start + rng.integers(min(space.n, 2)))
        else:
            action = rng.uniform(space.low, space.high).astype(space.dtype)
        results.append(env.step(action))
        if results[-1][2] or results[-1][3]:
            results.append(env.reset())
    return results


def the_passive_checker_has_nothing_to_say(name: str) -> None:
    env = make(name, disable_env_checker=True).unwrapped
    passive_env_checker.check_space(
        env.observation_space, "observation", passive_env_checker._check_box_observation_space
    )
    passive_env_checker.check_space(env.action_space, "action", passive_env_checker._check_box_action_space)
    observation, info = passive_env_checker.env_reset_passive_checker(env, seed=1)
    assert observation in env.observation_space
    assert isinstance(info, dict)
    env.action_space.seed(0)
    for _ in range(5):
        observation, reward, terminated, truncated, info = passive_env_checker.env_step_passive_checker(
            env, env.action_space.sample()
        )
        assert observation in env.observation_space
        assert np.isscalar(reward)
        assert isinstance(terminated, bool | np.bool_)
        assert truncated is False
        if terminated:
            env.reset()


def the_same_seed_gives_the_same_and_another_something_else(name: str) -> None:
    env, twin = make(name), make(name)
    first = walk(env)
    assert data_equivalence(walk(twin), first, exact=True)
    assert data_equivalence(walk(env), first, exact=True)
    states = []
    for seed in (7, 8):
        env.reset(seed=seed)
        assert env.unwrapped.np_random_seed == seed
        states.append(env.unwrapped.np_random.bit_generator.state)
    assert states[0] != states[1]


def an_assigned_generator_is_drawn_from(name: str) -> None:
    env, twin = make(name), make(name)
    env.reset(seed=1)
    twin.reset(seed=7)
    env.unwrapped.np_random = copy.deepcopy(twin.unwrapped.np_random)
    assert env.unwrapped.np_random_seed == -1
    if isinstance(env.unwrapped, KArmedBanditEnv):  # it keeps its problem until the next seed
        env.unwrapped.action_values = twin.get_wrapper_attr("action_values")
    assert data_equivalence(env.reset(), twin.reset(), exact=True)
    assert data_equivalence(walk(env, seed=None), walk(twin, seed=None), exact=True)


def spaces_are_seeded_apart_from_the_environment(name: str) -> None:
    env, twin = make(name), make(name)
    env.reset(seed=1)
    twin.reset(seed=1)
    env.action_space.seed(3)
    env.action_space.sample()
    env.observation_space.sample()
    assert data_equivalence(walk(env, seed=None), walk(twin, seed=None), exact=True)


def copies_continue(name: str) -> None:
    env = make(name)
    walk(env)
    for other in (copy.deepcopy(env), pickle.loads(pickle.dumps(env))):  # noqa: S301
        original = copy.deepcopy(env)
        assert type(other.unwrapped) is type(env.unwrapped)
        assert data_equivalence(walk(other, seed=None), walk(original, seed=None), exact=True)


def specs_survive_json_pickle_and_making_again(name: str) -> None:
    env = make(name, max_episode_steps=5)
    assert env.spec is not None
    assert env.spec.id == name
    assert env.spec.max_episode_steps == 5
    for spec in (env.spec, EnvSpec.from_json(env.spec.to_json()), pickle.loads(pickle.dumps(env.spec))):  # noqa: S301
        assert spec == env.spec
        again = gym.make(spec)
        assert again.spec == env.spec
        assert data_equivalence(walk(again), walk(env), exact=True)
    assert gym.spec(name).max_episode_steps == make(name).spec.max_episode_steps  # type: ignore[union-attr]
    assert name.rpartition("/")[2] in str(gym.pprint_registry(disable_print=True))


def wrappers_in_the_spec_are_made_again(name: str) -> None:
    env: Any = wrappers.ClipReward(wrappers.RecordEpisodeStatistics(make(name, max_episode_steps=4)), -0.5, 0.5)
    again: Any = gym.make(env.spec)
    layers: list[list[type]] = []
    for layer in (env, again):
        layers.append([])
        while isinstance(layer, gym.Wrapper):
            layers[-1].append(type(layer))
            layer = layer.env
    assert layers[0] == layers[1]
    for one, other in zip(walk(again), walk(env), strict=True):
        assert data_equivalence(one[:-1], other[:-1], exact=True)


def make_adds_the_wrappers_that_it_is_asked_for(name: str) -> None:
    def layers(**kwargs: Any) -> list[type]:
        found, env = [], make(name, **kwargs)
        while isinstance(env, gym.Wrapper):
            found.append(type(env))
            env = env.env
        return found

    assert wrappers.PassiveEnvChecker in layers()
    assert wrappers.PassiveEnvChecker not in layers(disable_env_checker=True)
    assert wrappers.TimeLimit in layers(max_episode_steps=3)
    assert wrappers.TimeLimit not in layers(max_episode_steps=-1)
    assert (wrappers.TimeLimit in layers()) == (gym.spec(name).max_episode_steps is not None)


def a_time_limit_truncates(name: str) -> None:
    env = make(name, max_episode_steps=1)
    env.reset(seed=0)
    *_, truncated, _ = env.step(env.action_space.sample())
    assert truncated is True


def a_step_or_frame_before_the_first_reset_is_refused(name: str) -> None:
    env = make(name)
    with pytest.raises(gym.error.ResetNeeded):
        env.step(env.action_space.sample())
    with pytest.raises(gym.error.ResetNeeded):
        env.render()
    env.close()
    env.close()


def statistics_of_a_vector_are_those_of_its_sub_environments(name: str) -> None:
    def short() -> gym.Env:
        return make(name, max_episode_steps=6)

    apart = SyncVectorEnv([lambda: wrappers.RecordEpisodeStatistics(short())] * 2)
    whole = wrappers.vector.RecordEpisodeStatistics(SyncVectorEnv([short] * 2))
    kept: list[list[Any]] = [[], []]
    for envs, seen in zip((whole, apart), kept, strict=True):
        envs.reset(seed=3)
        envs.action_space.seed(0)
        for _ in range(15):
            *_, infos = envs.step(envs.action_space.sample())
            if "episode" in infos:
                seen.append(
                    (infos["_episode"].tolist(), infos["episode"]["r"].tolist(), infos["episode"]["l"].tolist())
                )
    assert kept[0] == kept[1]
    assert kept[0]


CLAIMS: list[Callable[[str], None]] = [
    the_passive_checker_has_nothing_to_say,
    the_same_seed_gives_the_same_and_another_something_else,
    an_assigned_generator_is_drawn_from,
    spaces_are_seeded_apart_from_the_environment,
    copies_continue,
    specs_survive_json_pickle_and_making_again,
    wrappers_in_the_spec_are_made_again,
    make_adds_the_wrappers_that_it_is_asked_for,
    a_time_limit_truncates,
    a_step_or_frame_before_the_first_reset_is_refused,
    statistics_of_a_vector_are_those_of_its_sub_environments,
]


@pytest.mark.parametrize("claim", CLAIMS, ids=lambda claim: claim.__name__)
@pytest.mark.parametrize("name", IDS)
def test_every_environment(name: str, claim: Callable[[str], None]) -> None:
    claim(name)


@pytest.mark.parametrize("name", TWINS)
def test_gymnasium_finds_that_ours_matches_its_own(name: str) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # Gymnasium's function has no keyword for its checker
        ours, theirs = gym.make(name), gym.make(gymnasium_id(name))
        check_environments_match(ours, theirs, num_steps=60, seed=3, skip_render=True)
