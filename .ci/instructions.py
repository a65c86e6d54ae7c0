"""The instructions of a step of each benchmark, as Valgrind counts them, beside those that the repository holds.

Usage: instructions.py [--store] PROGRAM...

Counts do not depend on how busy a machine is, but on the compiler, on the C library and on whether the processor has
AVX2 and FMA; the file names them. Changes never fail the task; whoever edits the core reviews them.
"""

import json
import os
import platform
import re
import subprocess
import sys
import tempfile
from pathlib import Path

STORED = Path(__file__).parents[1] / "rust/core/benches/instructions.json"
SHOWN = 0.5
"""Changes of fewer percent are not printed."""


def run(program: str, name: str, runs: int, *counter: str) -> tuple[int, str]:
    """Returns the number of steps that a benchmark took in so many runs, and what the counter printed."""
    env = {**os.environ, "QTAB_BENCH": name, "QTAB_RUNS": str(runs)}
    done = subprocess.run([*counter, program], env=env, capture_output=True, text=True, check=True)
    return int(done.stdout), done.stderr


def instructions_per_step(program: str, name: str) -> float:
    """Counts a benchmark's second run, so that what happens once does not count."""
    counts, steps = [], []
    with tempfile.TemporaryDirectory() as folder:
        valgrind = ["valgrind", "--tool=callgrind", f"--callgrind-out-file={folder}/out"]
        for runs in (1, 2):
            taken, printed = run(program, name, runs, *valgrind)
            (collected,) = re.findall(r"Collected : (\d+)", printed)
            counts.append(int(collected))
            steps.append(taken)
    return (counts[1] - counts[0]) / (steps[1] - steps[0])


def machine() -> str:
    """Returns what the counts depend on."""
    rustc = subprocess.run(["rustc", "--version"], capture_output=True, text=True, check=True).stdout.split()[1]
    flags = Path("/proc/cpuinfo")
    wide = [name for name in ("avx2", "fma") if flags.exists() and name in flags.read_text().split()]
    return f"rustc {rustc}, {' '.join(platform.libc_ver())}, {' and '.join(wide) or 'no avx2'}"


def main() -> None:
    """Prints the counts, or stores them."""
    programs = [argument for argument in sys.argv[1:] if not argument.startswith("--")]
    stored = json.loads(STORED.read_text())
    counted = {}
    for program in programs:
        listing = {**os.environ, "QTAB_BENCH": "list"}
        names = subprocess.run([program], env=listing, capture_output=True, text=True, check=True)
        for name in names.stdout.splitlines():
            counted[name] = round(instructions_per_step(program, name), 1)
    if "--store" in sys.argv:
        STORED.write_text(json.dumps({"made with": machine(), "instructions per step": counted}, indent=2) + "\n")
        return
    before = stored["instructions per step"]
    print(f"stored: {stored['made with']}\nhere:   {machine()}")
    for name, count in counted.items():
        change = 100 * (count / before[name] - 1) if name in before else None
        if change is None or abs(change) >= SHOWN:
            text = "new" if change is None else f"{change:+.1f} %, was {before[name]:.1f}"
            print(f"{name:60} {count:8.1f}  {text}")
    print(f"{len(counted)} benchmarks; changes below {SHOWN} % are not shown")


main()
