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
from support.learner_settings import explorations, learning_rates, own_options
from support.masked import MaskedGraph
from support.parity import assert_same_run

ALGORITHMS = get_args(Algorithm)
MASKS = np.array([[1, 0, 1, 0], [0, 0, 0, 1], [1, 1, 1, 1]], np.int8)
TILES: dict[str, Any] = {"discretizer": "tiles", "tilings": 3, "tiles": (3, 2)}
BINS: dict[str, Any] = {"discretizer": "bins", "bins": (2, 2)}
SHORT: dict[str, Any] = {"episodes": 12, "max_episode_steps": 15}


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
        features = BINS if "dyna" in algorithm else draw(st.sampled_from([BINS, TILES]))
    return (
        masks,
        shown,
        {
            **features,
            **draw(learning_rates(0.5, by_visits=algorithm != "true_online_sarsa_lambda")),
            **draw(explorations()),
            **draw(own_options(algorithm)),
            "algorithm": algorithm,
            "bit_generator": draw(st.sampled_from(["PCG64", "MT19937"])),
            "on_truncation": draw(st.sampled_from(["bootstrap", "terminate"])),
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
@pytest.mark.parametrize("exploration", [{"epsilon": 0.7, "ties": "random"}, {"exploration": "softmax"}], ids=str)
def test_masks_that_differ_within_a_cell_are_kept_to(algorithm: Any, exploration: dict[str, Any]) -> None:
    chosen: dict[str, Any] = {"algorithm": algorithm, "seed": 3, **BINS, **exploration, **SHORT}
    every = np.ones_like(MASKS)
    env = MaskedGraph(every, "none", "box")
    run = qtab.train(env, action_mask=of_first_number, **chosen)
    for state, action in env.taken:
        assert of_first_number([state, 0.3 * state])[action]
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
    with pytest.raises(ValueError, match=r"^info\['action_mask'\] of reset of .*FrozenLake.* action_mask=f takes"):
        qtab.train("FrozenLake-v1", action_mask=True)

    def fails(observation: Any) -> Any:
        raise ZeroDivisionError(f"no mask for {observation}")

    with pytest.raises(ZeroDivisionError, match="no mask for 0"):
        qtab.train("FrozenLake-v1", action_mask=fails)


def test_a_state_that_is_never_reached_needs_no_mask() -> None:
    def only_of_the_start(observation: Any) -> Any:
        return {0: [1, 0, 0, 0]}[observation]

    chosen: dict[str, Any] = {"env_kwargs": {"is_slippery": False}, "seed": 0, "episodes": 1, "max_episode_steps": 3}
    run = qtab.train("FrozenLake-v1", action_mask=only_of_the_start, **chosen)
    assert run.config.backend == "gymnasium"
    assert run.action_masks is not None
    assert run.action_masks[:2].tolist() == [[True, False, False, False], [True] * 4]


def test_predictions_keep_to_the_masks() -> None:
    run = qtab.train(MaskedGraph(MASKS), action_mask=True, seed=0, **SHORT)
    assert run.predict(1)[0] == 3
    assert run.predict(np.array([1, 1]))[0].tolist() == [3, 3]
    assert {int(run.predict(0, deterministic=False)[0]) for _ in range(30)} <= {0, 2}
    assert np.isneginf(run.q_values(1)).tolist() == [True, True, True, False]
    assert run.values(1) == run.q_values(1)[3]
    # sb3-contrib's keyword goes before what was seen.
    assert run.predict(1, action_masks=[0, 1, 0, 0])[0] == 1
    assert run.predict([0, 1], action_masks=[[0, 1, 0, 0], [0, 0, 1, 0]])[0].tolist() == [1, 2]
    for bad, error in (
        ([0] * 4, ValueError),
        ([1] * 3, ValueError),
        ([[1] * 4] * 2, ValueError),
        ([0.5] * 4, TypeError),
    ):
        with pytest.raises(error, match=r"^action_masks must"):
            run.predict(1, action_masks=bad)


def test_tile_coding_predicts_with_a_mask_or_a_function() -> None:
    pytest.importorskip("matplotlib").use("agg")
    env = MaskedGraph(MASKS, shown="box")
    run = qtab.train(env, action_mask=True, seed=0, **TILES, **SHORT)
    assert run.action_masks is None
    observation = np.array([1.0, 0.3], np.float32)
    with pytest.raises(ValueError, match=r"^action_masks must be given: the run was trained with the masks of its env"):
        run.predict(observation)
    assert run.predict(observation, action_masks=MASKS[1])[0] == 3
    qtab.plots.trajectory(run, env=env, seed=0)  # with the masks of the environment, which refuses other actions
    run = qtab.train(env, action_mask=lambda seen: MASKS[min(int(seen[0]), 2)], seed=0, **TILES, **SHORT)
    assert run.predict(observation)[0] == 3
    assert run.predict(np.stack([observation, observation]))[0].tolist() == [3, 3]


def test_a_saved_run_remembers_its_masks(tmp_path: Any) -> None:
    run = qtab.train("Taxi-v4", action_mask=True, seed=0, episodes=5)
    run.save(tmp_path / "run.npz")
    loaded = qtab.load(tmp_path / "run.npz")
    assert loaded.config == run.config
    assert loaded.q_table.tobytes() == run.q_table.tobytes()
    assert qtab.verify(loaded).equal
    assert_same_run(qtab.resume(loaded, 9), qtab.resume(run, 9))
    with pytest.raises(ValueError, match=r"^action_mask must be left out for a run that was not trained with a funct"):
        qtab.load(tmp_path / "run.npz", action_mask=lambda _: [1] * 6)


def test_a_saved_run_asks_for_the_function_of_its_masks(tmp_path: Any) -> None:
    def masks(observation: Any) -> Any:
        return MASKS[min(observation, 2)]

    run = qtab.train(MaskedGraph(MASKS, "none"), action_mask=masks, seed=0, **SHORT)
    run.save(tmp_path / "run.npz")
    loaded = qtab.load(tmp_path / "run.npz")
    assert loaded.config.action_mask == "function"
    assert loaded.predict(1)[0] == 3  # as last seen
    for use in (qtab.verify, qtab.evaluate):
        with pytest.raises(ValueError, match=r"^action_mask must be given: .*qtab.load\(path, action_mask=f\)"):
            use(loaded, env=MaskedGraph(MASKS, "none"))
    again = qtab.load(tmp_path / "run.npz", action_mask=masks)
    assert again.config == run.config
    assert qtab.verify(again, env=MaskedGraph(MASKS, "none")).equal
    assert qtab.evaluate(again, episodes=2, seed=0, env=MaskedGraph(MASKS, "none")).lengths.min() > 0
    longer = qtab.train(MaskedGraph(MASKS, "none"), resume=tmp_path / "run.npz", action_mask=masks, episodes=20)
    assert_same_run(longer, qtab.resume(again, 20, env=MaskedGraph(MASKS, "none")))
    with pytest.raises(TypeError, match=r"^action_mask must be a function of the observation, got True"):
        qtab.load(tmp_path / "run.npz", action_mask=True)  # type: ignore[arg-type]


@pytest.mark.parametrize("algorithm", ["q_learning", "dyna_q", "dyna_q_plus"])
@pytest.mark.parametrize("backend", ["rust", "gymnasium"])
def test_a_run_that_was_stopped_is_resumed_exactly(algorithm: Any, backend: Any) -> None:
    chosen: dict[str, Any] = {"algorithm": algorithm, "seed": 2, "episodes": 8, "max_episode_steps": 40}
    whole = qtab.train("Taxi-v4", action_mask=True, backend=backend, **chosen)
    part = qtab.train(
        "Taxi-v4", action_mask=True, backend=backend, callback=lambda p: p.episodes < 3, callback_every=1, **chosen
    )
    assert_same_run(qtab.resume(part), whole)


def test_many_runs_keep_to_the_masks_too(tmp_path: Any) -> None:
    runs = qtab.train_many("Taxi-v4", seeds=2, action_mask=True, episodes=5, tables=True)
    assert_same_run(runs[1], qtab.train("Taxi-v4", seed=1, action_mask=True, episodes=5))
    assert runs[0].q_table.min() == -np.inf
    assert runs[:1][0].action_masks is not None
    runs.save(tmp_path / "runs.npz")
    assert qtab.load_runs(tmp_path / "runs.npz")[1].q_table.tobytes() == runs[1].q_table.tobytes()


def test_an_explanation_shows_the_masked_values() -> None:
    for algorithm in ("q_learning", "expected_sarsa", "double_q_learning"):
        run = qtab.train("Taxi-v4", action_mask=True, seed=0, episodes=3, max_episode_steps=20, algorithm=algorithm)
        step = qtab.explain(run, episode=2)[0]
        env: Any = gym.make("Taxi-v4").unwrapped
        assert np.isneginf(step.choice.values).tolist() == (env.action_mask(step.observation) == 0).tolist()
        assert np.isfinite(step.updates[0].target)


def test_a_diagnosis_does_not_ask_for_masked_actions() -> None:
    run = qtab.train("Taxi-v4", action_mask=True, seed=0, episodes=2500)
    assert "coverage" not in [finding.name for finding in qtab.diagnose(run).findings]


class Legal(gym.Wrapper[Any, Any, Any, Any]):
    """Refuses what the mask excludes."""

    def reset(self, **kwargs: Any) -> Any:
        observation, self.info = self.env.reset(**kwargs)
        return observation, self.info

    def step(self, action: Any) -> Any:
        assert self.info["action_mask"][action]
        *answer, self.info = self.env.step(action)
        return (*answer, self.info)


def test_a_played_episode_is_that_of_evaluate() -> None:
    run = qtab.train("Taxi-v4", action_mask=True, seed=0, episodes=30, max_episode_steps=25)
    played = qtab.play(run, 2, seed=5, window=False, env=Legal(gym.make("Taxi-v4", render_mode="rgb_array")))
    evaluated = qtab.evaluate(run, 2, seed=5)
    assert played.returns.tobytes() == evaluated.returns.tobytes()
