"""What the wheel must do in an environment that has its required dependencies only."""

import os
import sys
import sysconfig
from importlib.metadata import distributions

import gymnasium
import qtab

extras = {"matplotlib", "tqdm", "pygame"} & {found.metadata["Name"] for found in distributions()}
assert not extras, f"the wheel installed {extras}"

if sysconfig.get_config_var("Py_GIL_DISABLED"):
    assert not sys._is_gil_enabled(), "importing qtab turned the interpreter's lock on"

run = qtab.train("MountainCar-v0", seed=0, episodes=200)
assert qtab.verify(run, episodes=20).equal
run.save("run.npz")
verification = qtab.verify(qtab.load("run.npz"))
print(verification)
assert verification.equal

env = gymnasium.make("qtab/MountainCar-v0")
env.reset(seed=0)
env.step(env.action_space.sample())

if os.environ.get("QTAB_PLAYGROUND"):  # where it could be built
    assert '"wasm":"H4sI' in qtab.playground.page(), "the wheel lacks the WebAssembly module of the playground"

try:
    qtab.plot(run)
except ModuleNotFoundError as error:
    assert "pip install 'matplotlib" in str(error)
else:
    raise AssertionError("qtab.plot ran without matplotlib")
