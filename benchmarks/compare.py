"""Times qtab beside Gymnasium, NumPy loops, Numba and C, and prints the tables of docs/explanation/speed.md.

python benchmarks/compare.py training stepping --seconds 60
"""

import argparse
from collections.abc import Callable, Mapping, Sequence
from importlib.util import find_spec

import algorithms
import environment_presets
import idle_env
import mountain_car
import own_functions
import own_library
import own_start
import real_valued
import vector_envs
from loops import numba_loops
from qtab._utils.versions import versions
from tables import Table

PARTS: Mapping[str, Sequence[Callable[[], Table | own_start.StartTable]]] = {
    "training": [mountain_car.training],
    "environments": [environment_presets.training],
    "learners": [algorithms.learners],
    "features": [real_valued.learning],
    "book": [algorithms.book],
    "stepping": [mountain_car.stepping, idle_env.learning],
    "vectors": [vector_envs.stepping],
    "own": [own_functions.training, own_library.training, own_start.starting],
}


def main(arguments: Sequence[str] | None = None) -> None:
    """Times the named parts, or all of them."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("parts", nargs="*", metavar="PART", help=f"{', '.join(PARTS)}; by default all of them")
    parser.add_argument("--seconds", type=float, default=10.0, help="the approximate duration of a table (10)")
    parser.add_argument("--rounds", type=int, help="the number of rounds; by default as many as fit, at least 3")
    options = parser.parse_args(arguments)
    if unknown := set(options.parts) - set(PARTS):
        parser.error(f"PART must be one of {', '.join(PARTS)}, got {', '.join(sorted(unknown))}")
    if options.rounds is not None and options.rounds < 1:
        parser.error(f"--rounds must be at least 1, got {options.rounds}")
    found = versions()
    if found["build"] != "release":
        print(f"WARNING: this is a {found['build']} build, many times slower: maturin develop --release\n")
    if not numba_loops.numba:
        print("numba is not installed, and its loops are left out: pip install numba\n")
    parts = options.parts or [*PARTS]
    if not find_spec("envpool") and {"vectors", "own"} & set(parts):
        print("EnvPool is not installed, and its rows are left out: pip install envpool\n")
    for part in parts:
        for table in PARTS[part]:
            print(f"{table().measured(options.seconds, options.rounds)}\n", flush=True)
    print(
        "ns/step is the median over the rounds, × (times as fast) and rel. time the medians of the ratios in a round;"
    )
    print("for environments of one's own, they are the minima over the rounds and the ratios of these")
    print(", ".join(f"{name} {value}" for name, value in found.items()))


if __name__ == "__main__":
    main()
