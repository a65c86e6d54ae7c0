"""The mark of tests that need what only POSIX has."""

import os

import pytest

posix_only = pytest.mark.skipif(os.name != "posix", reason="needs POSIX: resource limits, signals or fork")
