"""Builds the site into docs/_build/html and checks it.

python docs/build.py                # everything, as `.ci/run docs` does
python docs/build.py --quick        # without running the notebooks, and without the browser

The checks: no warning of Sphinx, no broken link or anchor, no picture without a description, nothing from the network,
and the search finds what readers look for.
"""

import argparse
import shutil
import subprocess
import sys
import time
from pathlib import Path

HERE = Path(__file__).resolve().parent
SITE = HERE / "_build" / "html"
GENERATED = (HERE / "_build", HERE / "notebooks", HERE / "reference" / "api" / "generated")


def sphinx(quick: bool) -> int:
    """Builds the site from scratch; every warning is an error, and all of them are shown."""
    for folder in GENERATED:
        shutil.rmtree(folder, ignore_errors=True)
    options = ["-b", "html", "-j", "2", "-W", "--keep-going", "-n", "-q"]
    if quick:
        options += ["-D", "nb_execution_mode=off"]
    command = [sys.executable, "-m", "sphinx", *options, str(HERE), str(SITE)]
    returncode = subprocess.run(command, check=False).returncode  # noqa: S603 - a fixed command
    # The theme keeps this template among its static files, but it is not a page.
    (SITE / "_static" / "webpack-macros.html").unlink(missing_ok=True)
    return returncode


def main() -> None:
    """Builds and checks the site; the exit code is 1 if there is any problem."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--quick", action="store_true", help="without notebooks and browser")
    parser.add_argument("--browser", action=argparse.BooleanOptionalAction, default=True, help="open every page")
    asked = parser.parse_args()
    quick = asked.quick
    sys.path.insert(0, str(HERE / "_site" / "checks"))
    import browser
    import links
    import search
    import static

    began = time.perf_counter()
    failed = sphinx(quick) != 0
    print(f"built in {time.perf_counter() - began:.0f} s", flush=True)
    pages = static.read(SITE)
    problems = [*static.problems(SITE, pages), *links.problems(SITE, pages)]
    if asked.browser and not quick:
        problems += browser.problems(SITE) or search.problems(SITE)
    print(*problems, sep="\n")
    print(f"{len(pages)} pages, {len(problems)} problems, {time.perf_counter() - began:.0f} s")
    sys.exit(failed or bool(problems))


if __name__ == "__main__":
    main()
