"""evaluate and verify take another environment: by its id, its spec, or itself. It must have the run's spaces."""

from typing import Any

import gymnasium as gym
import pytest

import qtab
from support.environments import Walk


@pytest.fixture(scope="module")
def car():
    return qtab.train("MountainCar-v0", seed=0, episodes=20)


@pytest.fixture(scope="module")
def walk():
    return qtab.train(Walk(), scale=(2, 2), seed=0, episodes=3, max_episode_steps=20, progress=False)


@pytest.mark.parametrize("env", ["MountainCar-v0", "qtab/MountainCar-v0", gym.spec("MountainCar-v0")], ids=str)
def test_an_id_or_a_spec_is_an_environment(car, env):
    assert qtab.evaluate(car, 3, seed=1, env=env).returns.tolist() == qtab.evaluate(car, 3, seed=1).returns.tolist()
    assert qtab.evaluate(car, 3, seed=1, env=env).reward_threshold == -110
    assert qtab.verify(car, env=env).equal
    assert qtab.verify(car, episodes=4, env=env).episodes == 4


def test_keyword_arguments_go_to_the_id_that_is_given(car):
    faster: dict[str, Any] = {"goal_velocity": 0.05}
    found = qtab.evaluate(car, 3, seed=1, env="qtab/MountainCar-v0", env_kwargs=faster)
    assert found.returns.tolist() == qtab.evaluate(car, 3, seed=1, env_kwargs=faster).returns.tolist()


@pytest.mark.parametrize("function", [qtab.evaluate, qtab.verify])
@pytest.mark.parametrize(
    ("env", "other"),
    [("CartPole-v1", "CartPole-v1"), (gym.make("Taxi-v4"), "Taxi-v4"), (Walk(actions=2), "Walk"), (Walk(), "Walk")],
)
def test_an_environment_with_other_spaces_is_refused(car, function, env, other):
    with pytest.raises(ValueError, match=f"^env must have the spaces of the run's MountainCar-v0, got {other}"):
        function(car, env=env)


@pytest.mark.parametrize("function", [qtab.evaluate, qtab.verify])
def test_a_run_on_an_environment_without_an_id_asks_for_it(walk, function):
    with pytest.raises(
        gym.error.UnregisteredEnv, match="environment 'Walk' is not registered with Gymnasium: pass env="
    ):
        function(walk)
    with pytest.raises(TypeError, match=r"env must be an environment id, an EnvSpec or an environment, got 3"):
        function(walk, env=3)
    with pytest.raises(gym.error.NameNotFound):
        function(walk, env="NoSuchWalk-v0")
