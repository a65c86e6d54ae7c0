"""Makes the README's first picture: a trained agent driving, and the value function that it learned."""

from pathlib import Path

import gymnasium as gym
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

import qtab

SEED = 0
FADE = 0.3
"""How strongly the earlier positions of the car are drawn."""
FLAG = 0.5
"""The position of the goal."""
BEFORE_THE_FLAG = 8
"""The last car is drawn this many steps before the end: at the end it would hide the flag."""


def greedy_episode(run: qtab.Run, env: gym.Env) -> tuple[NDArray[np.float32], list[NDArray[np.uint8]]]:
    """Plays one episode with the greedy policy.

    Returns:
        The (n, 2) observations, position and velocity, and a (400, 600, 3) frame for each.
    """
    observation, _ = env.reset(seed=SEED)
    observations, frames, done = [observation], [env.render()], False
    while not done:
        observation, _, terminated, truncated, _ = env.step(run.predict(observation)[0])
        observations.append(observation)
        frames.append(env.render())
        done = terminated or truncated
    return np.array(observations), frames


def key_steps(observations: NDArray[np.float32]) -> list[int]:
    """Returns the first step, the steps at which the car changes direction, and one shortly before the end."""
    reversals = np.flatnonzero(np.diff(np.sign(observations[1:, 1]))) + 1
    return [0, *reversals.tolist(), len(observations) - 1 - BEFORE_THE_FLAG]


def draw_car(ax: Axes, observations: NDArray[np.float32], frames: list[NDArray[np.uint8]], steps: list[int]) -> None:
    """Draws the frame of the last key step, with the car at the earlier key steps faded."""
    earlier = [255 - FADE * (255.0 - frames[step]) for step in steps[:-1]]
    ax.imshow(np.min([frames[steps[-1]], *earlier], axis=0).astype(np.uint8))
    pixels = 600 / 1.8  # Gymnasium draws the 1.8 m from -1.2 to 0.6 on 600 pixels
    for number, step in enumerate(steps, 1):
        x = observations[step, 0]
        height = 0.45 * np.sin(3 * x) + 0.55
        number_at(ax, number, (x + 1.2) * pixels, 400 - height * pixels - 50)
    ax.set_axis_off()
    ax.set_title(f"Greedy policy: {len(frames) - 1} steps to the flag", loc="left")


def draw_values(ax: Axes, run: qtab.Run, observations: NDArray[np.float32], steps: list[int]) -> None:
    """Draws max_a Q(s, a) over the state space, states never visited in grey, and the episode over it."""
    positions, velocities = np.linspace(-1.2, 0.6, 217), np.linspace(-0.07, 0.07, 169)
    states = np.stack(np.meshgrid(positions, velocities), axis=-1).reshape(-1, 2)
    updated = run.tables[0].any(axis=1)
    visited = updated[run.discretizer.active_rows(states)].all(axis=1)
    values = np.where(visited, run.q_values(states).max(axis=1), np.nan).reshape(len(velocities), len(positions))
    image = ax.pcolormesh(positions, velocities, values, cmap="viridis", vmax=0, rasterized=True)
    ax.figure.colorbar(image, ax=ax, label="max$_a$ Q(s, a)", pad=0.02)
    ax.set_facecolor("0.88")
    ax.text(0.02, 0.94, "grey: never visited", transform=ax.transAxes, color="0.25", fontsize="small")
    ax.axvline(FLAG, color="black", linewidth=1, linestyle=(0, (4, 3)))
    ax.text(FLAG - 0.015, -0.067, "flag", ha="right", fontsize="small", color="0.25")
    ax.plot(*observations.T, color="black", linewidth=3.2)
    ax.plot(*observations.T, color="white", linewidth=1.6)
    for number, step in enumerate(steps, 1):
        number_at(ax, number, *observations[step])
    ax.set_xlim(-1.2, 0.6)
    ax.set_ylim(-0.07, 0.07)
    ax.set_xlabel("Position (m)")
    ax.set_ylabel("Velocity (m/step)")
    ax.set_title("Learned values, and the same episode", loc="left")


def number_at(ax: Axes, number: int, x: float, y: float) -> None:
    """Writes a number into a white circle."""
    circle = {"boxstyle": "circle,pad=0.2", "facecolor": "white", "edgecolor": "black", "linewidth": 0.8}
    ax.text(x, y, str(number), ha="center", va="center", fontsize=9, fontweight="bold", bbox=circle, zorder=5)


def main() -> None:
    """Trains, plays one episode and writes the picture beside this file."""
    run = qtab.train("MountainCar-v0", preset="solved", seed=SEED)
    observations, frames = greedy_episode(run, gym.make("MountainCar-v0", render_mode="rgb_array"))
    steps = key_steps(observations)
    print(run, steps)
    figure = Figure(figsize=(11, 3.7), layout="constrained")
    car, values = figure.subplots(1, 2, width_ratios=(1, 1.02))
    draw_car(car, observations, frames, steps)
    draw_values(values, run, observations, steps)
    figure.savefig(Path(__file__).with_suffix(".png"), dpi=120)


if __name__ == "__main__":
    main()
