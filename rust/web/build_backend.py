"""The build backend of the package: builds the WebAssembly module of the playground, and lets maturin do the rest.

``python rust/web/build_backend.py`` builds the module alone.
"""

import hashlib
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from wasm_sections import custom_section, exports, with_custom_section

ROOT = Path(__file__).resolve().parents[2]
MODULE = ROOT / "python/qtab/playground/page/qtab.wasm"
TARGET = "wasm32-unknown-unknown"
MISSING = f"Rust's target {TARGET} is missing, and rustup cannot add it here"
# What the module is built from.
SOURCES = ("Cargo.toml", "Cargo.lock", "rust/core/Cargo.toml", "rust/core/src", "rust/web")
# The custom section of the module that holds the digest of its sources.
SECTION = "qtab sources"
# The wasm-opt of Debian 12. Earlier ones were never tried.
OLDEST_OPTIMIZER = 108
# What rustc uses and all browsers have, and no other: wasm-opt's defaults depend on its version.
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


def add_target():
    """Returns whether Rust can compile for WebAssembly here, after rustup was asked for what is missing."""
    if has_target():
        return True
    rustup = shutil.which("rustup")
    return bool(rustup) and subprocess.run([rustup, "target", "add", TARGET], cwd=ROOT).returncode == 0 and has_target()


def digest_of_sources():
    """Returns a digest of the files that the module is built from."""
    digest = hashlib.sha256()
    for source in SOURCES:
        path = ROOT / source
        files = [path] if path.is_file() else path.rglob("*")
        for file in sorted(file for file in files if file.suffix in (".rs", ".toml", ".lock", ".py")):
            content = file.read_bytes().replace(b"\r\n", b"\n")
            digest.update(f"{file.relative_to(ROOT).as_posix()}\0{len(content)}\0".encode())
            digest.update(content)
    return digest.hexdigest()


def is_current(module):
    """Returns whether a module was built from the sources as they are."""
    return custom_section(module, SECTION) == digest_of_sources().encode()


def environment(given):
    """Returns the environment for cargo: without flags for rustc, which are those of the machine's own processor.

    An empty CARGO_ENCODED_RUSTFLAGS comes before RUSTFLAGS and before the flags in cargo's configuration files.
    """
    return {**{name: value for name, value in given.items() if name != "RUSTFLAGS"}, "CARGO_ENCODED_RUSTFLAGS": ""}


def compile_module():
    """Compiles the module and returns its file, which is where cargo says."""
    options = ["--package", "qtab-web", "--profile", "web", "--target", TARGET, "--locked"]
    command = ["cargo", "build", *options, "--message-format", "json-render-diagnostics"]
    built = subprocess.run(
        command, cwd=ROOT, env=environment(os.environ), check=True, stdout=subprocess.PIPE, encoding="utf-8"
    )
    messages = [json.loads(line) for line in built.stdout.splitlines() if line.startswith("{")]
    artifacts = [message for message in messages if message["reason"] == "compiler-artifact"]
    files = [file for artifact in artifacts for file in artifact["filenames"] if file.endswith("qtab_web.wasm")]
    return Path(files[-1])


def optimized(built):
    """Returns the module in a file, smaller and faster if a fitting wasm-opt of Binaryen is installed."""
    module = built.read_bytes()
    optimizer = shutil.which("wasm-opt")
    if not optimizer:
        return module
    printed = subprocess.run([optimizer, "--version"], capture_output=True, text=True).stdout
    version = re.search(r"version[ _](\d+)", printed)
    if not version or int(version[1]) < OLDEST_OPTIMIZER:
        return _unoptimized(module, f"{printed.strip() or optimizer} is older than version {OLDEST_OPTIMIZER}")
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "qtab.wasm"
        features = ["--mvp-features", *(f"--enable-{feature}" for feature in FEATURES)]
        done = subprocess.run([optimizer, "-O3", *features, str(built), "-o", str(out)])
        if done.returncode != 0:
            return _unoptimized(module, f"wasm-opt {version[1]} failed")
        smaller = out.read_bytes()
    if exports(smaller) != exports(module):
        return _unoptimized(module, f"wasm-opt {version[1]} changed what the module exports")
    return smaller


def _unoptimized(module, reason):
    print(f"warning: the module of the playground is not optimized, because {reason}", file=sys.stderr)
    return module


def build_module():
    """Builds qtab.wasm, with a digest of its sources inside."""
    module = with_custom_section(optimized(compile_module()), SECTION, digest_of_sources().encode())
    new = MODULE.with_suffix(".new")
    new.write_bytes(module)
    new.replace(MODULE)
    print(f"built {MODULE.relative_to(ROOT)}: {len(module)} bytes", file=sys.stderr)


def prepare():
    """Builds the module if that is possible, after adding Rust's target for it; an sdist holds the module already.

    Raises:
        RuntimeError: if there is a module of other sources that cannot be built anew.
    """
    if (ROOT / "PKG-INFO").exists():
        return
    if add_target():
        build_module()
    elif not MODULE.exists():
        print(f"warning: `qtab playground` is left out: {MISSING}", file=sys.stderr)
    elif not is_current(MODULE.read_bytes()):
        raise RuntimeError(
            f"{MODULE.relative_to(ROOT).as_posix()} was built from other sources, and cannot be built anew: {MISSING}. "
            "Add the target, or delete the file to leave `qtab playground` out."
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
    if not add_target():
        sys.exit(f"error: {MISSING}")
    build_module()
