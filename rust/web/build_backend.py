"""The build backend of the package: builds the WebAssembly module of the playground, and lets maturin do the rest.

``python rust/web/build_backend.py`` builds the module alone.
"""

import os
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
MODULE = ROOT / "python/qtab/playground/page/qtab.wasm"
TARGET = "wasm32-unknown-unknown"
# What rustc uses and all browsers have. `--all-features` would let wasm-opt write what some of them do not know yet.
FEATURES = ["bulk-memory", "multivalue", "mutable-globals", "nontrapping-float-to-int"]
FEATURES += ["reference-types", "sign-ext", "simd"]


def has_target():
    """Returns whether Rust can compile for WebAssembly here."""
    try:
        printed = subprocess.run(
            ["rustc", "--print", "target-libdir", "--target", TARGET], cwd=ROOT, capture_output=True, text=True
        )
    except OSError:
        return False
    return printed.returncode == 0 and any(Path(printed.stdout.strip()).glob("libcore-*.rlib"))


def build_module():
    """Builds qtab.wasm, smaller and faster where Binaryen's wasm-opt is installed."""
    subprocess.run(
        ["cargo", "build", "--package", "qtab-web", "--profile", "web", "--target", TARGET, "--locked"],
        cwd=ROOT,
        check=True,
    )
    folder = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target"))
    built = ROOT / folder / TARGET / "web/qtab_web.wasm"
    new = MODULE.with_suffix(".new")
    if optimizer := shutil.which("wasm-opt"):
        features = [f"--enable-{feature}" for feature in FEATURES]
        subprocess.run([optimizer, "-O3", *features, str(built), "-o", str(new)], check=True)
    else:
        shutil.copyfile(built, new)
    new.replace(MODULE)
    print(f"built {MODULE.relative_to(ROOT)}: {MODULE.stat().st_size} bytes", file=sys.stderr)


def prepare():
    """Builds the module if that is possible; an sdist holds it already."""
    if (ROOT / "PKG-INFO").exists():
        return
    if has_target():
        build_module()
    elif not MODULE.exists():
        print(
            f"warning: `qtab playground` is left out: Rust's target {TARGET} is missing (rustup target add {TARGET})",
            file=sys.stderr,
        )


def build_wheel(*arguments):
    """Builds a wheel, as PEP 517 says."""
    import maturin

    prepare()
    return maturin.build_wheel(*arguments)


def build_sdist(*arguments):
    """Builds an sdist, as PEP 517 says."""
    import maturin

    prepare()
    return maturin.build_sdist(*arguments)


def build_editable(*arguments):
    """Builds an editable wheel, as PEP 660 says."""
    import maturin

    prepare()
    return maturin.build_editable(*arguments)


def __getattr__(name):
    """Returns the other hooks, which are maturin's."""
    import maturin

    return getattr(maturin, name)


if __name__ == "__main__":
    if not has_target():
        sys.exit(f"Rust's target {TARGET} is missing: rustup target add {TARGET}")
    build_module()
