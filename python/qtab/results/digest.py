"""The digest of a saved run, which ties its header and its arrays together."""

import hashlib
import json
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

ALGORITHM = "sha256"


def digest(header: Mapping[str, Any], arrays: Mapping[str, NDArray[Any]]) -> str:
    """Returns the digest as hexadecimal digits: equal only for the same header and the same arrays.

    It is the SHA-256 of a JSON text, with sorted keys and no spaces, of the header and of each array's dtype and shape,
    followed by the bytes of the arrays in C order, sorted by name. The text determines how many bytes follow.

    Args:
        header: What ``json.loads`` returns for the header, so that a header that was read has the digest of the one
            that was written.
        arrays: The arrays by name, without the header.

    Raises:
        ValueError: if the header holds a number that JSON cannot.
    """
    layouts = {name: [array.dtype.str, list(array.shape)] for name, array in arrays.items()}
    text = json.dumps({"header": header, "arrays": layouts}, sort_keys=True, separators=(",", ":"), allow_nan=False)
    computed = hashlib.new(ALGORITHM, text.encode())
    for name in sorted(arrays):
        computed.update(np.ascontiguousarray(arrays[name]).reshape(-1).view(np.uint8).data)
    return computed.hexdigest()
