"""What the Gymnasium-facing classes share."""

from typing import TYPE_CHECKING, Any

from gymnasium.error import ResetNeeded

from qtab import _core

if TYPE_CHECKING:
    import gymnasium as gym


class Parameter:
    """A constant of the physics: reads and writes the one in Rust."""

    def __set_name__(self, owner: type, name: str) -> None:
        self._name = name

    def __get__(self, env: "RustPhysics | None", owner: type | None = None) -> Any:
        return self if env is None else env.parameter(self._name)

    def __set__(self, env: "RustPhysics", value: Any) -> None:
        env.set_parameter(self._name, value)


class RustPhysics(_core.Physics):
    """The base of an environment whose state and constants live in Rust; Gymnasium's class comes after it."""

    model: str
    """The name of the physics in Rust."""

    if TYPE_CHECKING:
        action_space: gym.Space[Any]

    def step_in_python(self, action: Any) -> Any:
        """Steps through Gymnasium's own code what f64 in Rust does not stand for, such as a float32 state.

        Raises:
            gymnasium.error.ResetNeeded: before the first reset.
        """
        if self.state is None:
            raise ResetNeeded("Cannot call env.step() before calling env.reset()")
        return super(_core.Physics, self).step(action)  # type: ignore[misc]

    def checked_action(self, action: Any) -> int:
        """Returns an action as an integer, or raises Gymnasium's own error."""
        assert self.action_space.contains(action), f"{action!r} ({type(action)}) invalid"  # noqa: S101 - Gymnasium's
        return int(action)

    def __getstate__(self) -> dict[str, Any]:
        """All that a copy needs: Python's attributes, and what lives in Rust."""
        names = _core.parameter_names(self.model)
        return {**self.__dict__, **{name: self.parameter(name) for name in names}, "state": self.state}

    def __setstate__(self, attributes: dict[str, Any]) -> None:
        for name, value in attributes.items():
            if name != "state" or value is not None:
                setattr(self, name, value)
