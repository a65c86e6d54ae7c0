"""The libraries that several tests use."""

from pathlib import Path

import pytest

from support.native.libraries import EXAMPLES, compile_c


@pytest.fixture(scope="session")
def lander(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The library of ``examples/own_environment_c/lander.c``."""
    return compile_c(EXAMPLES / "own_environment_c" / "lander.c", tmp_path_factory.mktemp("lander"), "lander")
