"""The tables that a browser learns equal those of ``qtab.train`` to the bit."""

import base64
import math
import random
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import qtab
from qtab.config.config import DEFAULTS
from qtab.config.options import LEARNS_WEIGHTED, OPTIONS, is_set
from qtab.config.validation import defaults
from qtab.playground import definitions
from qtab.playground.assemble import packed
from qtab.playground.bundle import bundle
from qtab.playground.settings import MAX_FEATURES, OFFERED, is_offered
from qtab.reference import LEARNERS
from qtab.reference.parts import weighted
from qtab.training.setup.run_env import make_run_env
from support.playground import PATIENCE, musl

pytestmark = [pytest.mark.browser, pytest.mark.slow]

PAGE = Path(qtab.__file__).parent / "playground/page"
SOURCES = {name: (PAGE / name).read_text(encoding="utf-8") for name in ("engine.js", "worker.js")}
# Trains by a request and returns the table and the returns of each seed, as base64 of float64.
TRAIN = """
async ({ request, given }) => {
  const { Engine, complete } = globalThis.engineModule;
  const settings = complete(request.environment.id, given);
  const bytes = (array) => {
    let text = "";
    for (const byte of new Uint8Array(array.buffer)) text += String.fromCharCode(byte);
    return btoa(text);
  };
  globalThis.engine ??= new Engine({ onMessage: (message) => globalThis.listener(message) });
  const result = await new Promise((resolve, reject) => {
    globalThis.listener = (message) => {
      if (message.type === "error") reject(new Error(message.message));
      if (message.type === "result" && message.state !== "training") resolve(message);
    };
    globalThis.engine.start({ ...request, settings });
  });
  const tables = [];
  for (const index of request.seeds.keys()) tables.push(bytes(await globalThis.engine.table(index)));
  return { settings, state: result.state, tables, returns: bytes(result.returns), lengths: [...result.lengths] };
}
"""

KNOWN = definitions()["environments"]
EQUAL = [environment for environment, known in KNOWN.items() if not known["chaotic"]]


@pytest.fixture(scope="module")
def engine(chromium: Any, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Any]:
    """A page that holds the engine alone."""
    script = bundle(SOURCES, "engine.js") + '\nglobalThis.engineModule = modules["engine.js"];'
    file = tmp_path_factory.mktemp("engine") / "engine.html"
    scripts = packed(script, bundle(SOURCES, "worker.js"))
    file.write_text(f"<!doctype html><body>{scripts}</body>", encoding="utf-8")
    page = chromium.new_page()
    page.set_default_timeout(PATIENCE)
    page.goto(file.as_uri())
    page.wait_for_function("globalThis.engineModule")
    yield page
    page.close()


def floats(encoded: str) -> NDArray[np.float64]:
    return np.frombuffer(base64.b64decode(encoded), np.float64)


def check(engine: Any, environment: dict[str, Any], given: dict[str, Any], seeds: list[int]) -> None:
    """Trains in the browser and in Python, and compares what both say."""
    request = {"environment": environment, "seeds": seeds}
    trained = engine.evaluate(TRAIN, {"request": request, "given": given})
    assert trained["state"] == "finished"
    known = definitions()["environments"][environment["id"]]
    kwargs: dict[str, Any] = {"env_kwargs": known["env_kwargs"]}
    env: Any = known["python"]
    if not env:
        grid = {**next(iter(known["grids"].values())), **environment}
        rewards = {(row, column): reward for row, column, reward in grid["rewards"]}
        env = qtab.book.grid_world(
            grid["layout"],
            wind=grid["wind"],
            step_reward=grid["step_reward"],
            goal_reward=grid["goal_reward"],
            rewards=rewards,
        )
        kwargs = {}
    settings = {name: tuple(value) if isinstance(value, list) else value for name, value in trained["settings"].items()}
    returns, lengths = floats(trained["returns"]).reshape(len(seeds), -1), np.array(trained["lengths"])
    for index, seed in enumerate(seeds):
        run = qtab.train(env, seed=seed, progress=False, **{**settings, **kwargs})
        table = floats(trained["tables"][index])
        # The platform's exponential function may differ in its last bit, and with it the expected value of softmax.
        if (settings["algorithm"], settings["exploration"]) == ("expected_sarsa", "softmax"):
            np.testing.assert_allclose(table, run.tables.ravel(), rtol=1e-9, atol=1e-9)
        else:
            assert table.tobytes() == run.tables.tobytes(), (environment, settings, seed)
        assert returns[index].tobytes() == run.episode_returns.tobytes()
        assert lengths.reshape(len(seeds), -1)[index].tolist() == run.episode_lengths.tolist()


def completed(given: dict[str, Any]) -> dict[str, Any]:
    """All settings that apply beside the given ones, as Python fills them in."""
    fields = {**DEFAULTS, **given}
    for name, option in OPTIONS.items():
        if fields[option.choice] not in option.values:
            fields[name] = None
        elif fields[name] is None:
            fields |= defaults(fields)
    plain = {name: list(value) if isinstance(value, tuple) else value for name, value in fields.items()}
    return {name: value for name, value in plain.items() if is_offered(name) and is_set(fields[name])}


def random_settings(rng: random.Random, environment: str, algorithm: str) -> dict[str, Any]:
    """Settings that go together, few enough episodes for a test."""
    known = definitions()["environments"][environment]
    given: dict[str, Any] = {
        "algorithm": algorithm,
        "episodes": rng.randint(5, 60),
        "learning_rate": rng.choice([0.05, 0.3, 1.0]),
        "discount": rng.choice([0.0, 0.9, 0.99, 1.0]),
        "epsilon": rng.choice([0.0, 0.2, 0.8]),
        "initial_q": rng.choice([0.0, -3.5, (-1.0, 1.0)]),
        "discretizer": rng.choice([name for name in known["discretizers"] if name != "fourier"]),
        "max_episode_steps": rng.choice([50, 200]),
        "bins": rng.randint(2, 8),
        "tiles": rng.randint(2, 6),
        "tilings": rng.choice([1, 3, 8, 16]),
        "n_steps": rng.choice([1, 3, 10]),
        "planning_steps": rng.choice([0, 1, 7]),
        "trace_decay": rng.choice([0.0, 0.5, 0.9]),
        "trace_cutoff": rng.choice([0.0, 0.01]),
        "temperature": rng.choice([0.3, 2.0]),
    }
    for name in ("exploration", "epsilon_schedule", "learning_rate_schedule", "traces", "ties", "on_truncation"):
        given[name] = rng.choice(OFFERED[name])
    given["bit_generator"] = rng.choice(OFFERED["bit_generator"])
    if algorithm in ("dyna_q", "dyna_q_plus") and given["discretizer"] == "tiles":
        given["discretizer"] = "bins"
    if algorithm == "true_online_sarsa_lambda" and given["learning_rate_schedule"] == "visits":
        given["learning_rate_schedule"] = "linear"
    one_step = ("q_learning", "sarsa", "expected_sarsa", "double_q_learning", "dyna_q", "dyna_q_plus")
    if algorithm in one_step and given["discretizer"] != "tiles":
        given["terminal_update"] = rng.choice(OFFERED["terminal_update"])
    return given


def test_two_hundred_seeds_of_the_article_equal_python(engine):
    given = {**definitions()["environments"]["MountainCar-v0"]["presets"]["article"], "episodes": 60}
    for first in range(0, 200, 50):
        check(engine, {"id": "MountainCar-v0"}, given, list(range(first, first + 50)))


@pytest.mark.parametrize("environment", KNOWN)
@pytest.mark.parametrize("algorithm", OFFERED["algorithm"])
def test_random_settings_equal_python(engine, environment, algorithm):
    rng = random.Random(f"{environment} {algorithm}")  # noqa: S311 - settings, not secrets
    for _ in range(3):
        given = random_settings(rng, environment, algorithm)
        if environment not in EQUAL:
            # Too few steps for a difference in the last bit to grow, and a small table of six components.
            given |= {"max_episode_steps": 20, "tiles": 2, "bins": 3}
        check(engine, {"id": environment}, given, [rng.randrange(2**32)])


@pytest.mark.parametrize("environment", EQUAL)
def test_presets_equal_python(engine, environment):
    for preset in definitions()["environments"][environment]["presets"].values():
        check(engine, {"id": environment}, {**preset, "episodes": 150}, [3])


def test_painted_grid_worlds_equal_python(engine):
    rng = random.Random(4)  # noqa: S311
    for seed in range(20):
        rows, columns = rng.randint(1, 7), rng.randint(2, 7)
        cells = [[rng.choice("....#") for _ in range(columns)] for _ in range(rows)]
        for letter in "SSG"[rng.randint(0, 1) :]:
            cells[rng.randrange(rows)][rng.randrange(columns)] = letter
        if not any("S" in row for row in cells):
            cells[0][0] = "S"
        painted = {
            "id": "grid",
            "layout": ["".join(row) for row in cells],
            "wind": [rng.randint(0, 2) for _ in range(columns)],
            "step_reward": rng.choice([-1, 0, -0.25]),
            "goal_reward": rng.choice([0, 10]),
            "rewards": [[rng.randrange(rows), rng.randrange(columns), rng.choice([-5.5, 3])] for _ in range(3)],
        }
        given = random_settings(rng, "grid", rng.choice(OFFERED["algorithm"]))
        check(engine, painted, given, [seed])


FOURIER: dict[str, Any] = {"discretizer": "fourier", "learning_rate": 0.004, "initial_q": 0.0, "discount": 1.0}
FOURIER |= {
    "epsilon": 0.1,
    "epsilon_schedule": "constant",
    "terminal_update": "target",
    "ties": "first",
    "traces": "accumulating",
}
SMALL_POLE = {"low": (-2.4, -2.5, -0.21, -3.5), "high": (2.4, 2.5, 0.21, 3.5), "order": 2}


def trained_with_features(engine: Any, environment: str, given: dict[str, Any]) -> tuple[Any, NDArray[np.float64]]:
    """Trains in the browser and in Python, which must take the same steps; returns Python's run, the page's table."""
    trained = engine.evaluate(TRAIN, {"request": {"environment": {"id": environment}, "seeds": [3]}, "given": given})
    given_back = trained["settings"].items()
    settings: Any = {name: tuple(value) if isinstance(value, list) else value for name, value in given_back}
    run = qtab.train(environment, seed=3, progress=False, **settings)
    assert trained["lengths"] == run.episode_lengths.tolist()
    assert floats(trained["returns"]).tobytes() == run.episode_returns.tobytes()
    return run, floats(trained["tables"][0]).reshape(run.tables.shape)


@pytest.mark.parametrize("algorithm", [name for name in OFFERED["algorithm"] if name in LEARNS_WEIGHTED])
def test_fourier_weights_equal_those_of_the_reference_with_the_cosines_of_the_page(engine, algorithm, monkeypatch):
    of_page = SimpleNamespace(**{**vars(math), "cos": musl.cos, "sin": musl.sin})
    for number, coupled in enumerate([True, False]):
        given = {**FOURIER, "algorithm": algorithm, "order": 3 + number, "coupled": coupled, "episodes": 6}
        run, table = trained_with_features(
            engine, "MountainCar-v0", {**given, "scale_step_sizes": algorithm != "sarsa"}
        )
        np.testing.assert_allclose(table, run.tables, rtol=0, atol=1e-10)
        with monkeypatch.context() as patched:
            patched.setattr(weighted, "math", of_page)
            found = LEARNERS[algorithm](make_run_env(run.config, of="gymnasium"), run.config)
        assert table.tobytes() == found[0].tobytes(), given
        assert found[2].tolist() == run.episode_lengths.tolist()


@pytest.mark.parametrize(
    ("environment", "changes"),
    [
        ("MountainCar-v0", {"order": 5, "n_steps": 16, "episodes": 300, "learning_rate_schedule": "linear"}),
        ("CartPole-v1", {**SMALL_POLE, "n_steps": 8, "episodes": 100}),
        ("Acrobot-v1", {"order": 1, "n_steps": 4, "episodes": 40, "max_episode_steps": 20}),
    ],
)
def test_long_runs_with_a_fourier_basis_take_the_same_steps_as_in_python(engine, environment, changes):
    run, table = trained_with_features(engine, environment, {**FOURIER, "algorithm": "n_step_sarsa", **changes})
    assert np.abs(table).max() > 0.1
    np.testing.assert_allclose(table, run.tables, rtol=0, atol=1e-8)


def test_the_largest_order_of_the_page_is_that_of_the_engine(engine):
    for environment, known in KNOWN.items():
        components = len(known["observations"] or ())
        if not components:
            continue
        rows = [(n + 1) ** components for n in range(1, 20) if (n + 1) ** components <= MAX_FEATURES]
        given = {**FOURIER, **(SMALL_POLE if environment == "CartPole-v1" else {}), "order": len(rows), "episodes": 1}
        request = {"request": {"environment": {"id": environment}, "seeds": [3]}, "given": given}
        assert len(floats(engine.evaluate(TRAIN, request)["tables"][0])) == rows[-1] * len(known["actions"])
        request["given"]["order"] += 1
        with pytest.raises(Exception, match=f"order must be small enough for {MAX_FEATURES} features"):
            engine.evaluate(TRAIN, request)


@pytest.mark.parametrize("environment", KNOWN)
def test_the_page_completes_settings_as_python_does(engine, environment):
    rng = random.Random(environment)  # noqa: S311
    known = definitions()["environments"][environment]
    for algorithm in OFFERED["algorithm"]:
        given = random_settings(rng, environment, algorithm)
        if "fourier" in known["discretizers"] and algorithm == "n_step_sarsa":
            given |= {**FOURIER, "learning_rate_schedule": "constant", "coupled": False}
        options = {"max_episode_steps": known["max_episode_steps"], **known["options"]}
        expected = completed({**options, **given})
        script = "(arguments) => globalThis.engineModule.complete(...arguments)"
        found = engine.evaluate(script, [environment, given])
        assert found == expected
