"""Which functions give the same bits in compiled code as in Python, and what to write instead of the others.

Both kinds of environments use these tables: the checks of a ``FunctionalEnv``, and the rewriting of ordinary classes.
"""

import math
from collections.abc import Callable
from typing import Any

BUILTINS = ("abs", "bool", "chr", "enumerate", "float", "int", "isinstance", "iter", "len", "list", "max", "min",
            "next", "ord", "print", "range", "round", "set", "slice", "sorted", "str", "sum", "tuple",
            "zip")  # fmt: skip
"""Python's own functions that give the same results, some of them with checks."""

MATH_CHECKED = ("sin", "cos", "tan", "asin", "acos", "atan", "exp", "log", "log10", "sqrt", "sinh", "cosh", "tanh",
                "log1p", "expm1", "log2")  # fmt: skip
"""Functions of ``math`` with the same bits that raise an error for some numbers."""
MATH_TESTS = ("isnan", "isinf", "isfinite")
MATH_ROUNDED = ("floor", "ceil", "trunc")
"""Functions whose results are integers."""
MATH_TWO = ("atan2", "copysign")
"""Functions of two arguments."""
MATH = (*MATH_CHECKED, *MATH_TESTS, *MATH_ROUNDED, *MATH_TWO, "fabs")
"""The functions of ``math`` with the same bits."""

MATH_ADVICE = {
    "pow": "write products, or math.exp(y * math.log(x))",
    "hypot": "write math.sqrt(x * x + y * y)",
    "dist": "write math.sqrt(x * x + y * y)",
    "radians": "write x * (math.pi / 180.0)",
    "degrees": "write x * (180.0 / math.pi)",
    "isclose": "write abs(x - y) <= 1e-9 * max(abs(x), abs(y))",
}
"""What to write instead of other functions of ``math``."""
OTHER_MATH = "use sin, cos, tan, exp, log, sqrt, floor, ceil or their like"
"""What to write instead of the functions that are not in ``MATH_ADVICE``."""

_SAME_AS_MATH = {
    **{name: name for name in ("exp", "expm1", "log", "log10", "log1p", "log2", "tan", "tanh", "sinh", "cosh")},
    **{"arctan": "atan", "arcsin": "asin", "arccos": "acos", "arctan2": "atan2"},
}
NUMPY_DIFFERENT = {
    **{name: f"write math.{other} for np.{name}" for name, other in _SAME_AS_MATH.items()},
    **dict.fromkeys(("power", "float_power"), "write products: x * x for x ** 2"),
    "hypot": "write math.sqrt(x * x + y * y)",
    **dict.fromkeys(("radians", "deg2rad"), "write x * (math.pi / 180.0)"),
    **dict.fromkeys(("degrees", "rad2deg"), "write x * (180.0 / math.pi)"),
    **dict.fromkeys(
        ("cbrt", "exp2", "logaddexp", "logaddexp2", "arcsinh", "arccosh", "arctanh", "sinc", "interp"),
        "write it with functions of math, or a loop",
    ),
    "ldexp": "multiply by the power of 2",
    "spacing": "write a small number, such as 1e-12",
    "histogram": "count the elements in a loop",
    **dict.fromkeys(("round", "around", "round_"), "leave out rounding, or write math.floor(x + 0.5)"),
}
"""Functions of NumPy that round differently in compiled code, and what to write instead."""

NUMPY_OPERATORS = {
    **dict.fromkeys(("mod", "remainder"), "write a % b"),
    "fmod": "write a % b, which has the sign of b",
    "floor_divide": "write a // b",
    "left_shift": "write a << b",
    "right_shift": "write a >> b",
    "sign": "compare the number with 0",
    **dict.fromkeys(("isclose", "allclose"), "write abs(a - b) <= 1e-8 + 1e-5 * abs(b)"),
    "broadcast_arrays": "write a loop over the elements",
    "copysign": "write math.copysign(x, y)",
    "signbit": "write math.copysign(1.0, x) < 0.0",
}
"""Functions of NumPy that differ for zeros, infinities, large shifts or the signs of NaN, and what to write instead."""

NUMPY_EXTREMES = {
    **{name: f"write {name[:3]}(x, y)" for name in ("minimum", "maximum")},
    **{name: f"write a loop with {name[-3:]}(x, y)" for name in ("min", "max", "amin", "amax", "nanmin", "nanmax")},
}
"""Functions of NumPy whose zeros may differ in sign for floats, and what to write instead."""

NUMPY_SAME = (
    "absolute", "add", "all", "any", "append", "arange", "argmax", "argmin", "argwhere", "array", "array_equal",
    "array_split", "asarray", "ascontiguousarray", "asfortranarray", "atleast_1d", "atleast_2d", "bincount",
    "bitwise_and", "bitwise_or", "bitwise_xor", "broadcast_to", "ceil", "clip", "column_stack", "concatenate",
    "conjugate", "copy", "cos", "count_nonzero", "diag", "diff", "digitize", "divide", "empty", "empty_like", "equal",
    "expand_dims", "eye", "fabs", "finfo", "flatnonzero", "flip", "fliplr", "flipud", "floor", "full", "full_like",
    "greater", "greater_equal", "hstack", "identity", "iinfo", "invert", "isfinite", "isinf", "isnan", "isscalar",
    "less", "less_equal", "logical_and", "logical_not", "logical_or", "logical_xor", "multiply", "ndindex", "negative",
    "nonzero", "not_equal", "ones", "ones_like", "positive", "ravel", "real", "reciprocal", "repeat", "reshape", "rint",
    "roll", "rot90", "searchsorted", "shape", "sin", "size", "split", "sqrt", "square", "stack", "subtract", "swapaxes",
    "take", "transpose", "tril", "triu", "trunc", "vstack", "where", "zeros", "zeros_like",
)  # fmt: skip
"""Functions of NumPy that give the same results, some of them with checks. Others that have no advice are refused."""

NUMPY_JOINS = ("append", "diff", "digitize", "searchsorted", "where")
"""Functions that bring numbers to one type, which depends on more than their types in Python."""

NUMPY_OF_FLOATS = ("sin", "cos", "sqrt", "fabs", "isnan", "isinf", "isfinite", "full_like", "zeros", "ones", "empty")
"""Functions of NumPy whose results have the same type for integers as for floats."""

NUMPY_OF_BOOLEANS = ("logical_and", "logical_or", "logical_xor", "logical_not", "bitwise_and", "bitwise_or",
                     "bitwise_xor", "invert", "equal", "not_equal", "less", "less_equal", "greater",
                     "greater_equal")  # fmt: skip
"""Functions of NumPy that compute with booleans as compiled code does. Others have results of 16 bits, or none."""

NUMPY_SUMS = {"sum", "mean", "std", "var", "dot", "matmul", "prod", "cumsum", "cumprod", "vdot", "inner", "average",
              "median", "percentile", "quantile", "nansum", "nanmean", "nanstd", "nanvar", "nanprod", "nancumsum",
              "nancumprod", "nanmedian", "trapz", "trapezoid", "norm", "convolve", "correlate", "cov",
              "corrcoef"}  # fmt: skip
"""Functions that may add or multiply floats in another order."""

NUMPY_SUMS_OF_INTEGERS = {"sum", "prod", "cumsum", "cumprod", "nansum", "nanprod", "nancumsum", "nancumprod"}
"""Those of them that are exact for integers. The others compute with floats."""

NUMPY_SORTS = {
    **dict.fromkeys(("sort", "unique", "partition"), "sort integers, or search in a loop"),
    **dict.fromkeys(("argsort", "argpartition"), "search for the elements in a loop"),
}
"""Functions that may exchange equal elements, which are the same number only among integers."""

NUMPY_WRITES = {"nan_to_num", "fill_diagonal", "nditer", "ndenumerate", "copyto", "put", "place", "putmask"}
"""Functions that may change an array of ``self`` without an error."""

_POSITIVE = "{} > 0.0"
_NOT_NEGATIVE = "({0} >= 0.0 and math.copysign(1.0, {0}) > 0.0)"  # NumPy refuses -0.0
_ANY = "True"
DRAWS: dict[str, tuple[str, str]] = {
    "random": ("", _ANY),
    "standard_normal": ("", _ANY),
    "standard_exponential": ("", _ANY),
    "standard_cauchy": ("", _ANY),
    "uniform": ("low=0.0, high=1.0", f"high - low < math.inf and {_NOT_NEGATIVE.format('(high - low)')}"),
    "normal": ("loc=0.0, scale=1.0", _NOT_NEGATIVE.format("scale")),
    "lognormal": ("mean=0.0, sigma=1.0", _NOT_NEGATIVE.format("sigma")),
    "logistic": ("loc=0.0, scale=1.0", _NOT_NEGATIVE.format("scale")),
    "laplace": ("loc=0.0, scale=1.0", _NOT_NEGATIVE.format("scale")),
    "exponential": ("scale=1.0", _NOT_NEGATIVE.format("scale")),
    "rayleigh": ("scale=1.0", _NOT_NEGATIVE.format("scale")),
    "gamma": ("shape, scale=1.0", f"{_NOT_NEGATIVE.format('shape')} and {_NOT_NEGATIVE.format('scale')}"),
    "standard_gamma": ("shape", _NOT_NEGATIVE.format("shape")),
    "weibull": ("a", _NOT_NEGATIVE.format("a")),
    "pareto": ("a", _POSITIVE.format("a")),
    "standard_t": ("df", _POSITIVE.format("df")),
    "chisquare": ("df", _POSITIVE.format("df")),
    "f": ("dfnum, dfden", "dfnum > 0.0 and dfden > 0.0"),
    "noncentral_chisquare": ("df, nonc", f"df > 0.0 and {_NOT_NEGATIVE.format('nonc')}"),
    "noncentral_f": ("dfnum, dfden, nonc", f"dfnum > 0.0 and dfden > 0.0 and {_NOT_NEGATIVE.format('nonc')}"),
    "beta": ("a, b", "a > 0.0 and b > 0.0 and (a > 0.06 or b > 0.06)"),
    "triangular": ("left, mode, right", "left <= mode <= right and left < right"),
    "poisson": ("lam=1.0", "0.0 <= lam < 10.0"),  # beyond that, Numba's own algorithm differs
    "geometric": ("p", "1e-9 <= p <= 1.0"),  # below, the numbers may not fit 64 bits
    "binomial": ("n, p", "n >= 0 and 0.0 <= p <= 1.0"),
    "logseries": ("p", "0.0 < p < 1.0"),
    "zipf": ("a", "1.0 < a < 1e9"),
}
"""The methods of generators that draw the same numbers: the parameters before ``size``, and the condition for which
they do. NumPy raises errors for other arguments; Numba draws with any."""

DRAWS_OF_INTEGERS = ("poisson", "geometric", "binomial", "logseries", "zipf")

DRAWS_DIFFERENT = ("wald", "power", "negative_binomial")
"""Draws whose numbers can differ from NumPy's."""

DRAWS_MISSING = {
    "choice": "draw an index with rng.integers(0, n); with p=, compare rng.random() with the cumulative probabilities",
    "hypergeometric": "count the successes of single draws with rng.random()",
    "multinomial": "compare rng.random() with cumulative probabilities",
    "multivariate_normal": "combine draws of rng.normal(0.0, 1.0)",
    "dirichlet": "divide draws of rng.gamma(shape, 1.0) by their sum",
    "vonmises": "draw from another distribution, such as rng.uniform(-math.pi, math.pi)",
    "gumbel": "write -math.log(rng.exponential(1.0))",
}
"""Methods of generators that Numba does not have, and what to write instead. The draws then differ."""


def draw_check(name: str) -> Callable[..., None]:
    """Returns a function of the arguments of a draw, which raises ``ValueError`` where the draw would differ."""
    parameters, condition = DRAWS[name]
    scope: dict[str, Any] = {"math": math}
    parameters += ", size=None" if parameters else "size=None"
    exec(f"def check({parameters}):\n    if not ({condition}):\n        raise ValueError\n", scope)  # noqa: S102
    check: Callable[..., None] = scope["check"]
    return check
