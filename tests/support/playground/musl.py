"""The cosine and the sine of the page: Rust's for WebAssembly, which are those of musl and FreeBSD (fdlibm), in Python.

On other platforms Rust and Python call the system's functions, which now and then differ from these in the last bit.
"""

import math
import struct

COSINE = (
    4.16666666666666019037e-02,
    -1.38888888888741095749e-03,
    2.48015872894767294178e-05,
    -2.75573143513906633035e-07,
    2.08757232129817482790e-09,
    -1.13596475577881948265e-11,
)
SINE = (
    -1.66666666666666324348e-01,
    8.33333333332248946124e-03,
    -1.98412698298579493134e-04,
    2.75573137070700676789e-06,
    -2.50507602534068634195e-08,
    1.58969099521155010221e-10,
)
# Parts of π/2, each followed by the rest after it.
HALF_PI = (
    (1.57079632673412561417e00, 6.07710050650619224932e-11),
    (6.07710050630396597660e-11, 2.02226624879595063154e-21),
    (2.02226624871116645580e-21, 8.47842766036889956997e-32),
)


def cos(x: float) -> float:
    """Returns the cosine of a number in [0, π]."""
    quarter, y, rest = reduced(x)
    return (_cos(y, rest), -_sin(y, rest, quarter), -_cos(y, rest))[quarter]


def sin(x: float) -> float:
    """Returns the sine of a number in [0, π]."""
    quarter, y, rest = reduced(x)
    return (_sin(y, rest, quarter), _cos(y, rest), -_sin(y, rest, quarter))[quarter]


def reduced(x: float) -> tuple[int, float, float]:
    """Returns n and x - n π/2, in [-π/4, π/4], as the sum of two numbers."""
    high = _high(x)
    if high <= 0x3FE921FB:
        return 0, x, 0.0
    if high & 0xFFFFF == 0x921FB:  # near π/2 or π, where digits cancel
        return _precisely_reduced(x)
    n = 1 if high <= 0x4002D97C else 2
    part, rest = (n * each for each in HALF_PI[0])
    z = x - part
    y = z - rest
    return n, y, (z - y) - rest


def _precisely_reduced(x: float) -> tuple[int, float, float]:
    n = round(x * (2 / math.pi))
    (part, rest), *others = HALF_PI
    r, w = x - n * part, n * rest
    y = r - w
    for (part, rest), cancelled in zip(others, (16, 49), strict=True):
        if _exponent(x) - _exponent(y) <= cancelled:
            break
        before, lost = r, n * part
        r = before - lost
        w = n * rest - ((before - r) - lost)
        y = r - w
    return n, y, (r - y) - w


def _cos(x: float, y: float) -> float:
    c1, c2, c3, c4, c5, c6 = COSINE
    z = x * x
    w = z * z
    r = z * (c1 + z * (c2 + z * c3)) + w * w * (c4 + z * (c5 + z * c6))
    half = 0.5 * z
    w = 1.0 - half
    return w + (((1.0 - w) - half) + (z * r - x * y))


def _sin(x: float, y: float, quarter: int) -> float:
    s1, s2, s3, s4, s5, s6 = SINE
    z = x * x
    w = z * z
    r = s2 + z * (s3 + z * s4) + z * w * (s5 + z * s6)
    v = z * x
    return x - ((z * (0.5 * y - v * r) - y) - v * s1) if quarter else x + v * (s1 + z * r)


def _high(x: float) -> int:
    """The upper half of the bits of a number, without its sign."""
    return int(struct.unpack("<Q", struct.pack("<d", x))[0] >> 32) & 0x7FFFFFFF


def _exponent(x: float) -> int:
    return _high(x) >> 20
