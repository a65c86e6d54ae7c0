"""Explanations of runs with weighted features: the equations of the updates with their numbers."""

from typing import Any

import numpy as np
import pytest

import qtab
from qtab.config.options import LEARNS_WEIGHTED, PREFERENCES

FOURIER: dict[str, Any] = {"discretizer": "fourier", "order": 2, "learning_rate": 0.01, "progress": False, "seed": 1}


def explained(algorithm: Any, **settings: Any) -> Any:
    run = qtab.train("MountainCar-v0", algorithm=algorithm, episodes=4, max_episode_steps=30, **{**FOURIER, **settings})
    return qtab.explain(run, 2, steps=30)


@pytest.mark.parametrize("algorithm", [one for one in LEARNS_WEIGHTED if one not in PREFERENCES])
def test_an_update_moves_the_value_by_the_gain_times_the_error(algorithm: Any) -> None:
    explanation = explained(algorithm)
    updates = [update for step in explanation.steps for update in step.updates]
    assert len(updates) >= 25
    for update in updates:
        x, alpha = np.array(update.features), np.array(update.step_sizes)
        z = np.array(update.traces) if update.traces else x
        change = (alpha * z * x).sum() * update.error
        if update.old_value is not None:  # true online Sarsa(λ)
            difference = update.before - update.old_value
            change = (alpha * z * x).sum() * (update.error + difference) - (alpha * x * x).sum() * difference
        assert update.after - update.before == pytest.approx(change, abs=1e-12)
        assert update.before == pytest.approx(np.dot(update.weights_before, x), abs=1e-12)
        assert ("Σ α z x" if update.traces else "Σ α x²") in update.equations[-1]
    assert "features 1, " in str(explanation)
    assert str(explanation.steps[0].features[1])[:4] in explanation._repr_html_()


@pytest.mark.parametrize("algorithm", [one for one in LEARNS_WEIGHTED if one in PREFERENCES])
def test_an_update_moves_the_preference_along_the_gradient(algorithm: Any) -> None:
    explanation = explained(algorithm, temperature=0.7, scale_step_sizes=True)
    updates = [update for step in explanation.steps for update in step.policy_updates]
    assert len(updates) == len(explanation.steps) == 30
    for update in updates:
        x, alpha = np.array(update.features), np.array(update.step_sizes)
        assert (alpha[0], len(set(update.step_sizes))) == (update.step_size, 5)
        if update.traces:
            change = (alpha * np.array(update.traces)[:, update.action] * x).sum() * update.error
        else:
            change = (alpha * x * x).sum() * update.power * update.error * update.gradient[update.action]
        before, after = update.preferences
        assert after - before == pytest.approx(change, abs=1e-12)
        assert ("Σ α z x δ" if update.traces else "Σ α x² ") in update.equations[-1]
    assert "Σ α" in explanation._repr_html_()
