"""Values in the description of an environment: they are restored from JSON as they were, or not at all."""

import json
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from qtab.envs.origin.values import NotRestorableError, describe_value, restored, same

PLAIN = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text("abc"),
    lambda part: st.lists(part, max_size=3) | st.tuples(part, part) | st.dictionaries(st.text("xyz"), part, max_size=3),
    max_leaves=6,
)


@given(PLAIN)
def test_plain_values_are_restored_from_json(value: Any) -> None:
    content = json.loads(json.dumps(describe_value(value), allow_nan=False))
    assert same(content, describe_value(value))
    assert repr(restored(content)) == repr(value)


@pytest.mark.parametrize("value", [np.float32(0.1), np.array([[1.5, np.nan]]), np.int8(3), np.array([True, False])])
def test_arrays_are_restored_with_their_dtypes(value: Any) -> None:
    found = restored(json.loads(json.dumps(describe_value(value))))
    assert np.asarray(found).dtype == value.dtype
    assert np.asarray(found).tobytes() == value.tobytes()


def test_of_large_arrays_a_digest_is_kept() -> None:
    one, other = describe_value(np.zeros(10_000)), describe_value(np.ones(10_000))
    assert not same(one, other)
    with pytest.raises(NotRestorableError, match=r"an array of shape \(10000,\)"):
        restored(one)
