"""Each call that takes a run uses the environment that it was trained on, or says that it cannot, and why."""

import inspect
from collections.abc import Callable
from pathlib import Path
from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from gymnasium.envs.classic_control import mountain_car
from gymnasium.envs.registration import WrapperSpec
from gymnasium.wrappers import RescaleObservation, TransformReward

import qtab
from qtab.callbacks import EvaluateEvery, KeepBest

CAR = "MountainCar-v0"
SHORT: dict[str, Any] = {"episodes": 3, "seed": 0, "max_episode_steps": 15, "progress": False}


def easy() -> Any:
    """MountainCar with a goal that every episode reaches at once: no return is that of the usual task."""
    env: Any = gym.make(CAR, max_episode_steps=15)
    env.unwrapped.goal_position, env.unwrapped.goal_velocity = -1.1, -1.0
    return env


def rescaled() -> Any:
    return RescaleObservation(easy(), np.float32(0), np.float32(1))


def unknown() -> Any:
    return TransformReward(easy(), lambda reward: 3 * float(reward))


def trained(make: Callable[[], Any]) -> qtab.Run:
    return qtab.train(make(), discretizer="bins", bins=4, **SHORT)


def evaluated_during_training(callback: Any) -> Callable[[qtab.Run], Any]:
    def call(run: qtab.Run) -> Any:
        used = callback(episodes=2)
        qtab.train(config=run.config, callback=used, progress=False)
        return used.evaluations[-1].returns.tolist()

    return call


CALLS: dict[str, Callable[[qtab.Run], Any]] = {
    "evaluate": lambda run: qtab.evaluate(run, 2, seed=0).returns.tolist(),
    "resume": lambda run: qtab.resume(run, 5, progress=False).episode_returns[-2:].tolist(),
    "train": lambda run: qtab.train(config=run.config, progress=False).episode_returns[-2:].tolist(),
    "train_many": lambda run: qtab.train_many(config=run.config, seeds=[0], threads=1).episode_returns[0, -2:].tolist(),
    "verify": lambda run: [-1.0, -1.0] if qtab.verify(run).equal else "different",
    "explain": lambda run: [qtab.explain(run, episode=2).episode_return] * 2,
    "play": lambda run: qtab.play(run, 2, seed=0, window=False).returns.tolist(),
    "EvaluateEvery": evaluated_during_training(EvaluateEvery),
    "KeepBest": evaluated_during_training(KeepBest),
}
"""Each with the returns of two of its episodes."""
OTHERS = {
    "animate": "draws the tables",
    "diagnose": "is asked for by can_repeat, see below",
    "optimum": "see below",
    "plot": "draws the returns",
    "sweep": "see the tests of sweeps",
}
"""The public functions that take a run or its config and step no environment of their own, or are tested elsewhere."""


@pytest.mark.parametrize("name", [name for name in CALLS if name != "train_many"])
@pytest.mark.parametrize("make", [easy, rescaled])
def test_each_call_uses_the_environment_of_the_training(name: str, make: Callable[[], Any]) -> None:
    assert CALLS[name](trained(make)) == [-1.0, -1.0]


@pytest.mark.slow
def test_many_runs_of_a_config_train_in_the_environment_of_the_training() -> None:
    assert CALLS["train_many"](trained(rescaled)) == [-1.0, -1.0]  # in processes


@pytest.mark.parametrize("name", CALLS)
def test_each_call_asks_for_an_environment_that_cannot_be_made_again(name: str) -> None:
    with pytest.raises(ValueError, match=r"^env must be given: .* its wrapper TransformReward was made with"):
        CALLS[name](trained(unknown))


def test_no_public_call_that_takes_a_run_is_forgotten() -> None:
    taking = set()
    for name in vars(qtab)["__all__"]:
        value = getattr(qtab, name, None) if name not in ("sb3", "playground") else None
        if inspect.isfunction(value) and {"run", "config", "resume"} & inspect.signature(value).parameters.keys():
            taking.add(name)
    assert taking <= {*CALLS, *OTHERS}


@pytest.mark.parametrize("call", [qtab.resume, qtab.verify, qtab.explain])
def test_a_given_environment_must_be_that_of_the_training(call: Any) -> None:
    run = trained(rescaled)
    more = {"episodes": 5} if call is qtab.resume else {}
    other = RescaleObservation(gym.make(CAR, max_episode_steps=15), np.float32(0), np.float32(1))
    with pytest.raises(ValueError, match=r"its attribute goal_position was -1\.1, and is now 0\.5"):
        call(run, env=other, **more)
    assert call(run, env=rescaled(), **more) is not None


def test_another_time_limit_replaces_that_of_a_wrapped_environment() -> None:
    run = trained(lambda: RescaleObservation(gym.make(CAR, max_episode_steps=15), np.float32(0), np.float32(1)))
    longer: dict[str, Any] = {"max_episode_steps": 20, "progress": False}
    again = qtab.train(config=run.config, **longer)
    assert (again.config.max_episode_steps, again.episode_lengths.tolist()) == (20, [20, 20, 20])
    assert qtab.evaluate(run, 2, seed=0, **longer).lengths.tolist() == [20, 20]
    with pytest.raises(ValueError, match="max_episode_steps must be that of the run to resume, 15, got 20"):
        qtab.train(resume=run, episodes=5, **longer)
    with pytest.raises(TypeError, match="max_episode_steps must be an integer"):
        qtab.train(config=run.config, max_episode_steps=20.5)  # type: ignore[arg-type]


def test_a_grid_has_no_time_limit_that_the_environment_would_shorten() -> None:
    with pytest.raises(
        ValueError, match=r"max_episode_steps must be at most 15 in the grid, the time limit .* got 20$"
    ):
        qtab.sweep(None, {"max_episode_steps": [5, 20]}, 1, config=trained(rescaled).config)


@pytest.mark.slow
def test_a_sweep_of_a_wrapped_environment_has_another_time_limit() -> None:
    run = trained(lambda: RescaleObservation(gym.make(CAR, max_episode_steps=15), np.float32(0), np.float32(1)))
    table = qtab.sweep(None, {"discount": [0.5]}, 1, config=run.config, max_episode_steps=20, threads=1)
    assert table.run(0, 0).episode_lengths.tolist() == [20, 20, 20]


@pytest.mark.parametrize(("make", "change"), [(easy, "its attribute goal_position was"), (rescaled, "it was in the")])
def test_other_arguments_do_not_undo_what_was_changed(make: Callable[[], Any], change: str) -> None:
    run, other = trained(make), {"goal_velocity": 0.01}
    message = rf"^env must be given: .* other env_kwargs are given, and .*{change}"
    with pytest.raises(ValueError, match=message):
        qtab.evaluate(run, 2, seed=0, env_kwargs=other)
    with pytest.raises(ValueError, match=message):
        qtab.train(config=run.config, env_kwargs=other)
    unchanged = qtab.train(CAR, **SHORT)
    assert qtab.train(config=unchanged.config, env_kwargs=other).config.env_kwargs == other


def test_other_arguments_go_to_an_id_that_adds_wrappers() -> None:
    clip = WrapperSpec("ClipReward", "gymnasium.wrappers:ClipReward", {"min_reward": -0.5, "max_reward": 0.0})
    gym.register("QtabTests/Clipped-v0", gym.spec(CAR).entry_point, max_episode_steps=15, additional_wrappers=(clip,))
    try:
        run = trained(lambda: gym.make("QtabTests/Clipped-v0"))
        assert qtab.evaluate(run, 1, seed=0, env_kwargs={"goal_velocity": 0.01}).returns.tolist() == [-7.5]
    finally:
        del gym.registry["QtabTests/Clipped-v0"]


def test_an_optimum_with_other_arguments_is_not_that_of_the_run() -> None:
    run = qtab.train("FrozenLake-v1", env_kwargs={"is_slippery": False}, episodes=5, seed=0)
    other = qtab.optimum("FrozenLake-v1")
    with pytest.raises(ValueError, match="run must have env_kwargs"):
        other.gap(run)
    pytest.importorskip("matplotlib")
    with pytest.raises(ValueError, match="run must have env_kwargs"):
        qtab.plots.difference(run, other)


def test_a_saved_run_knows_its_environment(tmp_path: Path) -> None:
    run = trained(rescaled)
    run.save(tmp_path / "run.npz")
    loaded = qtab.load(tmp_path / "run.npz")
    assert loaded.trained_on == run.trained_on
    assert loaded.config.origin == run.config.origin
    assert qtab.evaluate(loaded, 2, seed=0).returns.tolist() == [-1.0, -1.0]


@pytest.mark.parametrize("given", [CAR, "object"])
def test_a_replaced_method_of_gymnasiums_is_used(given: str, monkeypatch: pytest.MonkeyPatch) -> None:
    plain = qtab.train(CAR, **SHORT)

    def step(self: Any, action: Any) -> Any:
        return np.array(self.state, np.float32), -7.0, True, False, {}

    monkeypatch.setattr("gymnasium.envs.classic_control.mountain_car.MountainCarEnv.step", step)
    run = qtab.train(gym.make(CAR) if given == "object" else CAR, **SHORT)
    assert run.episode_returns.tolist() == [-7.0] * 3
    with pytest.raises(ValueError, match="methods of its class MountainCarEnv have been replaced since"):
        qtab.evaluate(plain, 2, seed=0)


def test_a_replaced_class_of_gymnasiums_is_used(monkeypatch: pytest.MonkeyPatch) -> None:
    class MountainCarEnv(mountain_car.MountainCarEnv):
        def step(self, action: Any) -> Any:
            return np.array(self.state, np.float32), -7.0, True, False, {}

    monkeypatch.setattr(mountain_car, "MountainCarEnv", MountainCarEnv)
    assert qtab.train(CAR, **SHORT).episode_returns.tolist() == [-7.0] * 3


def test_what_was_derived_is_derived_again() -> None:
    pole = qtab.train("CartPole-v0", episodes=2, seed=0, progress=False)
    assert qtab.train("CartPole-v1", config=pole.config, progress=False).config.max_episode_steps == 500
    assert pole.config.replace(env="CartPole-v1").max_episode_steps is None
    asked = qtab.train("CartPole-v0", episodes=2, seed=0, max_episode_steps=50, progress=False)
    assert qtab.train("CartPole-v1", config=asked.config, progress=False).config.max_episode_steps == 50
    lake = qtab.train("FrozenLake-v1", time_aware=True, episodes=2, seed=0, progress=False)
    configs = [
        qtab.train(config=lake.config, time_aware=False, progress=False).config,
        lake.config.replace(time_aware=False),
        lake.at_step(1).config,
    ]
    assert [config.on_truncation for config in configs] == ["bootstrap"] * 3
    read = qtab.train(CAR, discretizer=lambda _: 0, shape=(1,), **SHORT)
    assert read.config.backend == "gymnasium"
    assert qtab.train(config=read.config, discretizer="bins", bins=4, progress=False).config.backend == "rust"


def test_an_evaluation_breaks_ties_as_predict_does() -> None:
    run = qtab.train("qtab/DynaMaze-v0", episodes=2, seed=0, learning_rate=0.0, max_episode_steps=20, progress=False)
    assert run.config.ties == "random"
    env = gym.make("qtab/DynaMaze-v0", max_episode_steps=20)
    found = qtab.evaluate(run, 3, seed=1)
    observation, _ = env.reset(seed=1)
    total, over = 0.0, False
    while not over:
        observation, reward, terminated, truncated, _ = env.step(run.predict(observation)[0])
        total, over = total + float(reward), terminated or truncated
    assert found.returns[0] == total
    assert len(set(found.lengths.tolist())) == 1
