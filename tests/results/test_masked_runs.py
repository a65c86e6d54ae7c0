"""What can be done with a run that was trained with action masks: predict, save, resume, explain, play."""

from pathlib import Path
from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from gymnasium.spaces import Box, Dict, Discrete, MultiDiscrete, Tuple
from gymnasium.vector.utils import concatenate, create_empty_array

import qtab
from support.environments import Sampled
from support.environments.masked import MASKS, SHORT, TILES, MaskedGraph
from support.parity import assert_same_run


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


NESTED: dict[str, gym.Space[Any]] = {
    "dict": Dict(b=Discrete(3), a=Discrete(4, start=2)),
    "tuple_of_discretes": Tuple((Discrete(3), Discrete(2), Discrete(4, start=-1))),
    "tuple": Tuple((Box(0, 2, (2,), np.int64), Discrete(3))),
    "deep": Dict(x=Dict(y=Discrete(2), z=Tuple((Discrete(3), MultiDiscrete([2, 2])))), w=Box(0, 3, (2, 2), np.int64)),
    "multi_discrete": MultiDiscrete([2, 3, 4]),
    "floats": Dict(place=Box(-1.0, 1.0, (2,)), room=Discrete(2)),
}


@pytest.mark.parametrize("max_rows", [None, 500])
@pytest.mark.parametrize("name", NESTED)
def test_a_function_gets_the_observations_of_a_batch_one_by_one(
    name: str, max_rows: int | None, tmp_path: Path
) -> None:
    space = NESTED[name]

    def mask(observation: Any) -> Any:
        allowed = np.ones(3, bool)
        numbers: Any = gym.spaces.flatten(space, observation)
        allowed[int(np.abs(numbers).sum() * 7) % 3] = False
        return allowed

    features: dict[str, Any] = {"discretizer": "bins", "bins": 3} if name == "floats" else {}
    settings: dict[str, Any] = {"episodes": 3, "max_episode_steps": 10, "seed": 0, "max_rows": max_rows, **features}
    run = qtab.train(Sampled(space), action_mask=mask, **settings)
    run.save(tmp_path / "run.npz")
    space.seed(1)
    for count in (1, 2, 3, 5):
        observations = [space.sample() for _ in range(count)]
        empty: Any = create_empty_array(space, count)
        batch = concatenate(space, observations, empty)
        for one in (run, qtab.load(tmp_path / "run.npz", action_mask=mask)):
            values = np.array([one.q_values(observation) for observation in observations])
            assert one.q_values(batch).tobytes() == values.tobytes()
            assert one.predict(batch)[0].tolist() == [one.predict(observation)[0] for observation in observations]
            drawn = one.predict(batch, deterministic=False)[0]
            assert all(mask(seen)[action - 2] for seen, action in zip(observations, drawn.tolist(), strict=True))


def test_a_batch_without_observations_has_no_actions() -> None:
    for space in NESTED.values():
        options: dict[str, Any] = {"discretizer": "bins"} if space is NESTED["floats"] else {}
        run = qtab.train(Sampled(space), action_mask=lambda _: [1, 0, 1], episodes=1, max_episode_steps=5, **options)
        assert run.predict(create_empty_array(space, 0))[0].shape == (0,)
        assert run.predict(create_empty_array(space, 0), deterministic=False)[0].shape == (0,)


def test_a_row_of_numbers_is_passed_to_the_function_in_the_structure_of_the_space() -> None:
    space = NESTED["dict"]
    seen: list[Any] = []

    def mask(observation: Any) -> Any:
        seen.append(observation)
        return [1, 1, observation["b"] == 1]

    run = qtab.train(Sampled(space), action_mask=mask, **SHORT, seed=0)
    seen.clear()
    assert np.isneginf(run.q_values(np.array([[1, 2], [0, 2]]))).tolist() == [[False] * 3, [False, False, True]]
    assert np.isneginf(run.q_values(np.array([0.0, 2.0]))).tolist() == [False, False, True]
    assert seen == [{"a": 2, "b": 1}, {"a": 2, "b": 0}, {"a": 2, "b": 0}]
