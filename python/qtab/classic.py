"""What Rust trains on by its own physics: the constants of Gymnasium's environment as it stands."""

from typing import Any

import numpy as np

from qtab import _core, plan
from qtab.actions import Actions


def describe(env: Any, model: str, actions: Actions) -> plan.Control:
    """Returns an environment of Gymnasium's classic control as the extension module takes it.

    Raises:
        ValueError: for an attribute, an action space or a machine for which Rust does not compute what NumPy does.
    """
    if not _core.computes_as_numpy(model):
        raise ValueError("NumPy's sin and cos are not the platform's on this machine, which Rust calls")
    if actions.values is not None and actions.values.dtype != np.float32:
        raise ValueError(f"Rust computes with actions of float32, got {actions.values.dtype}")
    forces = [] if actions.values is None else actions.values[:, 0].tolist()
    return {"constants": _core.Classic(model, env), "forces": forces}
