"""Action masks: every learner and policy keeps to them, and gives the table of its NumPy reference."""

from typing import Any, get_args

import gymnasium as gym
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

import qtab
from qtab.config.choices import Algorithm
from qtab.config.options import NO_MASKED_TILES, PREFERENCES, TABLES_ONLY, WITH_PROBABILITIES
from support.environments.masked import MASKS, SHORT, TILES, MaskedGraph
from support.learners.learner_settings import (
    BY_EPISODE,
    explorations,
    learning_rates,
    own_options,
    possible_explorations,
)
from support.parity import assert_same_run

ALGORITHMS = get_args(Algorithm)
BINS: dict[str, Any] = {"discretizer": "bins", "bins": (2, 2)}


def of_first_number(observation: Any) -> Any:
    """A mask that two observations of the same cell may not share."""
    return [True, observation[0] < 1.5, observation[1] > 0.2, False]


@st.composite
def masked_runs(draw: st.DrawFn) -> tuple[NDArray[Any], str, dict[str, Any]]:
    states, actions = draw(st.integers(1, 4)), draw(st.integers(1, 5))
    rows = st.lists(st.booleans(), min_size=actions, max_size=actions).filter(any)
    masks: NDArray[Any] = np.array(
        [draw(rows) for _ in range(states)], draw(st.sampled_from([np.int8, np.bool_, np.int64]))
    )
    algorithm = draw(st.sampled_from(ALGORITHMS))
    shown = draw(st.sampled_from(["discrete", "box"]))
    features: dict[str, Any] = {"discretizer": "identity"}
    if shown == "box":
        features = BINS if algorithm in (*TABLES_ONLY, *NO_MASKED_TILES) else draw(st.sampled_from([BINS, TILES]))
    return (
        masks,
        shown,
        {
            **features,
            **draw(learning_rates(0.5, by_visits=algorithm not in BY_EPISODE, algorithm=algorithm)),
            **draw(explorations(possible_explorations(algorithm, features))),
            "algorithm": algorithm,
            "bit_generator": draw(st.sampled_from(["PCG64", "MT19937"])),
            "on_truncation": draw(st.sampled_from(["bootstrap", "terminate"])),
            **draw(own_options(algorithm)),
            "seed": draw(st.integers(0, 2**32 - 1)),
            **SHORT,
        },
    )


@given(masked_runs(), st.sampled_from(["info", "method"]))
def test_random_masks_give_the_table_of_the_reference(drawn: tuple[Any, str, dict[str, Any]], by: str) -> None:
    masks, shown, chosen = drawn
    # The environment refuses what its mask excludes.
    run = qtab.train(MaskedGraph(masks, by, shown), action_mask=True, **chosen)
    assert qtab.verify(run, env=MaskedGraph(masks, by, shown)).equal
    assert qtab.verify(run, episodes=5, env=MaskedGraph(masks, by, shown)).equal
    qtab.evaluate(run, episodes=3, seed=0, env=MaskedGraph(masks, by, shown))


@pytest.mark.parametrize("algorithm", ALGORITHMS)
@pytest.mark.parametrize(
    "exploration", [{"epsilon": 0.7, "ties": "random"}, {"exploration": "softmax"}, {"exploration": "ucb"}], ids=str
)
def test_masks_that_differ_within_a_cell_are_kept_to(algorithm: Any, exploration: dict[str, Any]) -> None:
    if algorithm in PREFERENCES:
        exploration = {"temperature": 0.5 if "epsilon" in exploration else 1.0}
    if algorithm in WITH_PROBABILITIES and exploration == {"exploration": "ucb"}:
        exploration = {"epsilon": 1.0}
    chosen: dict[str, Any] = {"algorithm": algorithm, "seed": 3, **BINS, **exploration, **SHORT}
    every = np.ones_like(MASKS)
    env = MaskedGraph(every, "none", "box")
    run = qtab.train(env, action_mask=of_first_number, **chosen)
    for state, action in env.taken:
        assert of_first_number([state, 0.3 * state])[action]
    assert qtab.verify(run, env=MaskedGraph(every, "none", "box")).equal


@pytest.mark.parametrize("algorithm", ["n_step_tree_backup", "n_step_q_sigma"])
@pytest.mark.parametrize("exploration", [{"epsilon": 0.7}, {"epsilon": 0.7, "ties": "random"}, {"temperature": 0.5}])
def test_an_action_that_its_cell_no_longer_has_is_backed_up_with_probability_zero(
    algorithm: Any, exploration: dict[str, Any]
) -> None:
    chosen: dict[str, Any] = {"algorithm": algorithm, "target_policy": "behavior", "seed": 3, **BINS, **SHORT}
    if "temperature" in exploration:
        chosen["exploration"] = "softmax"
    every = np.ones_like(MASKS)
    run = qtab.train(MaskedGraph(every, "none", "box"), action_mask=of_first_number, **chosen, **exploration)
    assert qtab.verify(run, env=MaskedGraph(every, "none", "box")).equal


@pytest.mark.parametrize("algorithm", ALGORITHMS)
def test_taxi_with_its_own_masks_is_the_same_in_rust_in_python_and_in_the_reference(algorithm: Any) -> None:
    chosen: dict[str, Any] = {"algorithm": algorithm, "seed": 1, "episodes": 4, "max_episode_steps": 60}
    rust, python = (
        qtab.train("Taxi-v4", action_mask=True, backend=backend, **chosen) for backend in ("rust", "gymnasium")
    )
    assert rust.tables.tobytes() == python.tables.tobytes()
    assert rust.episode_returns.tobytes() == python.episode_returns.tobytes()
    assert qtab.verify(rust).equal
    unmasked = qtab.train("Taxi-v4", **chosen)
    assert unmasked.tables.tobytes() != rust.tables.tobytes()


def test_taxi_never_takes_a_masked_action() -> None:
    run = qtab.train("Taxi-v4", action_mask=True, seed=0, episodes=200, visits=True)
    env: Any = gym.make("Taxi-v4").unwrapped
    masks = np.array([env.action_mask(state) for state in range(500)]).astype(bool)
    assert run.config.backend == "rust"
    assert run.visits is not None
    assert run.visits.sum() == run.episode_lengths.sum()
    assert not run.visits[~masks].any()
    assert run.action_masks is not None
    assert (run.action_masks == masks).all()
    assert (np.isneginf(run.q_table) == ~masks).all()
    assert masks[np.arange(500), run.policy].all()


@pytest.mark.parametrize("fickle", [False, True])
def test_a_function_gives_the_masks_of_discrete_observations_to_rust(fickle: bool) -> None:
    env: Any = gym.make("Taxi-v4").unwrapped
    chosen: dict[str, Any] = {"env_kwargs": {"fickle_passenger": fickle}, "seed": 1, "episodes": 5}
    given, own = (qtab.train("Taxi-v4", action_mask=mask, **chosen) for mask in (env.action_mask, True))
    assert given.config.backend == "rust"
    assert_same_run(given, own)


def test_a_function_of_continuous_observations_is_called_in_python() -> None:
    def no_push_at_the_wall(observation: Any) -> Any:
        return [observation[0] > -1.1, True, True]

    run = qtab.train("MountainCar-v0", action_mask=no_push_at_the_wall, seed=0, episodes=3)
    assert run.config.backend == "gymnasium"
    assert qtab.verify(run).equal
    with pytest.raises(ValueError, match=r"^backend must be .* got 'rust': its action masks are known only from step"):
        qtab.train("MountainCar-v0", action_mask=no_push_at_the_wall, backend="rust")


def test_an_environment_whose_actions_are_missing_from_the_start_gives_the_same_as_its_masks() -> None:
    chosen: dict[str, Any] = {"seed": 3, "episodes": 30, "epsilon": 0.5}
    masked = qtab.train("qtab/MaximizationBias-v0", action_mask=True, initial_q=0.0, **chosen)
    first = np.zeros((3, 10))
    first[0, 2:] = -np.inf
    missing = qtab.train("qtab/MaximizationBias-v0", initial_q=first, **chosen)
    assert masked.config.backend == missing.config.backend == "rust"
    assert masked.q_table.tobytes() == missing.q_table.tobytes()
    assert masked.episode_returns.tobytes() == missing.episode_returns.tobytes()


@pytest.mark.parametrize("algorithm", ["n_step_tree_backup", "n_step_q_sigma"])
def test_learners_that_back_up_earlier_states_refuse_masks_with_tile_coding(algorithm: Any) -> None:
    with pytest.raises(ValueError, match=r"^action_mask must be False for algorithm .* discretizer 'tiles', got True"):
        qtab.Config(algorithm=algorithm, discretizer="tiles", action_mask=True)
    assert qtab.Config(algorithm=algorithm, discretizer="bins", action_mask=True).action_mask is True


def test_masks_are_off_unless_they_are_asked_for() -> None:
    run = qtab.train("Taxi-v4", seed=0, episodes=3)
    assert (run.config.action_mask, run.action_masks) == (False, None)
    assert np.isfinite(run.q_table).all()


@pytest.mark.parametrize(
    ("mask", "error", "message"),
    [
        (np.ones(3, np.int8), ValueError, r"must have shape \(4,\), with an item for each action, got \(3,\)"),
        (np.ones((1, 4), np.int8), ValueError, r"must have shape \(4,\), with an item for each action, got \(1, 4\)"),
        (np.ones(4), TypeError, r"must be an array of 4 booleans, one for each action, got ndarray"),
        ("1111", TypeError, r"must be an array of 4 booleans, one for each action, got str: '1111'"),
        (None, TypeError, r"must be an array of 4 booleans, one for each action, got NoneType: None"),
        ([[1], [1, 1]], TypeError, r"must be an array of 4 booleans"),
        (np.array([1, 2, 0, 0], np.int8), ValueError, r"must hold booleans, or 0 and 1, got array\(\[1, 2, 0, 0\]"),
        (np.array([1, -1, 0, 0]), ValueError, r"must hold booleans, or 0 and 1, got array\(\[ 1, -1,  0,  0\]"),
        (np.zeros(4, np.bool_), ValueError, r"must leave at least one action, got array\(\[False, False"),
        ([0, 0, 0, 0], ValueError, r"must leave at least one action, got \[0, 0, 0, 0\]"),
    ],
    ids=str,
)
def test_a_bad_mask_is_refused_at_its_step(mask: Any, error: type[Exception], message: str) -> None:
    class Bad(MaskedGraph):
        def mask(self, state: int) -> Any:
            return mask if self.taken else super().mask(state)

    with pytest.raises(error, match=rf"^info\['action_mask'\] of step of <Bad instance> {message}"):
        qtab.train(Bad(MASKS), action_mask=True, seed=0, episodes=1)
    with pytest.raises(error, match=rf"^action_mask\(\d\) {message}") as caught:
        qtab.train(MaskedGraph(MASKS), action_mask=lambda _: mask, seed=5, episodes=1)
    assert len(caught.value.run.episode_returns) == 0  # type: ignore[attr-defined]


def test_an_environment_without_masks_and_a_function_that_fails_are_named() -> None:
    with pytest.raises(
        ValueError, match=r"^info\['action_mask'\] of reset of .*FrozenLake.* action_mask=f, a function"
    ):
        qtab.train("FrozenLake-v1", action_mask=True)

    def fails(observation: Any) -> Any:
        raise ZeroDivisionError(f"no mask for {observation}")

    with pytest.raises(ZeroDivisionError, match="no mask for 0"):
        qtab.train("FrozenLake-v1", action_mask=fails)


def test_an_error_of_a_function_is_raised_whichever_state_it_was_asked_for() -> None:
    def fails_far_away(observation: Any) -> Any:
        return [True, True, True, observation.left]

    def fails_at_the_goal(observation: Any) -> Any:
        return [True] * 4 if observation < 15 else [1 / 0] * 4

    for function, error in ((fails_far_away, AttributeError), (fails_at_the_goal, ZeroDivisionError)):
        with pytest.raises(error) as caught:  # FrozenLake's goal, state 15, is terminal and never asked for in Python
            qtab.train("FrozenLake-v1", action_mask=function, seed=0, episodes=1)
        notes = getattr(caught.value, "__notes__", ["in action_mask("])
        assert notes[0].startswith("in action_mask(")


def test_a_state_that_is_never_reached_needs_no_mask() -> None:
    def only_of_the_start(observation: Any) -> Any:
        return {0: [1, 0, 0, 0]}[observation]

    chosen: dict[str, Any] = {"env_kwargs": {"is_slippery": False}, "seed": 0, "episodes": 1, "max_episode_steps": 3}
    run = qtab.train("FrozenLake-v1", action_mask=only_of_the_start, **chosen)
    assert run.config.backend == "gymnasium"
    assert run.action_masks is not None
    assert run.action_masks[:2].tolist() == [[True, False, False, False], [True] * 4]
