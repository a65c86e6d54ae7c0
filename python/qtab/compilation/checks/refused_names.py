"""Names of functions that users' compiled code may not call, and what to write instead."""

from qtab.compilation.checks.source_constructs import DIFFERENT, SUMS
from qtab.compilation.rewriting.library.numpy_functions import SAME_AS_MATH

NUMPY_REFUSED = {
    **{name: f"write math.{other}" for name, other in SAME_AS_MATH.items()},
    **{name.removeprefix("np."): f"write {other}" for name, other in DIFFERENT.items()},
    "power": "write products: x * x for x ** 2",
    "float_power": "write products: x * x for x ** 2",
    "hypot": "write math.sqrt(x * x + y * y)",
    "radians": "write x * (math.pi / 180.0)",
    "deg2rad": "write x * (math.pi / 180.0)",
    "degrees": "write x * (180.0 / math.pi)",
    "rad2deg": "write x * (180.0 / math.pi)",
    **dict.fromkeys(
        ("cbrt", "exp2", "logaddexp", "logaddexp2", "arcsinh", "arccosh", "arctanh", "sinc", "interp"),
        "write it with functions of math, or a loop",
    ),
    **dict.fromkeys(("round", "around", "round_"), "leave out rounding, or write math.floor(x + 0.5)"),
}
"""Functions of NumPy whose results can differ, and what to write instead."""

SUMS_REFUSED = {*SUMS, "cumprod", "vdot", "inner", "average", "median", "percentile", "quantile", "nansum", "nanmean",
                "nanstd", "nanvar", "nanprod", "nancumsum", "nancumprod", "nanmedian", "trapz", "trapezoid", "norm",
                "convolve", "correlate", "cov", "corrcoef"}  # fmt: skip
"""Functions that may add or multiply floats in another order."""

WRITES_REFUSED = {"nan_to_num", "fill_diagonal", "nditer", "ndenumerate", "copyto", "put", "place", "putmask"}
"""Functions that may change an array of ``self`` without an error."""

MATH_ADVICE = {
    "pow": "write products, or math.exp(y * math.log(x))",
    "hypot": "write math.sqrt(x * x + y * y)",
    "radians": "write x * (math.pi / 180.0)",
    "degrees": "write x * (180.0 / math.pi)",
}
