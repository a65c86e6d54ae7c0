# Tasks of the release workflow, for .ci/run, which sources this file. They read TAG, REPOSITORY, TARGET and
# FREE_THREADED.

# The sdist in dist/. `.ci/run wheel sdist` first builds a wheel from it, installs that and runs it.
sdist() {
    built_wheel
    mkdir -p dist
    cp "$work"/dist/qtab-*.tar.gz dist/
}

# The wheels of $TARGET, or of this machine, in dist/: one for the stable ABI, and one for each free-threaded interpreter
# of $FREE_THREADED. From 3.15 on, free-threaded Pythons have a stable ABI too. Zig links those for Linux, so that they
# run with old C libraries; it also builds for aarch64 on x86_64, and then needs no interpreter.
wheels() {
    local target=${TARGET:-$(rustc -vV | sed -n 's/^host: //p')} interpreter
    local options=(--release --locked --out dist --target "$target")
    case $target in
        *-linux-gnu) options+=(--zig --compatibility manylinux2014) ;;
        *-linux-musl) options+=(--zig --compatibility musllinux_1_2) ;;
    esac
    [ -d .venv-release ] || "$host_python" -m venv .venv-release
    .venv-release/$bin/pip install --quiet --require-hashes -r .ci/release.txt
    if command -v rustup >/dev/null; then
        rustup target add "$target"
    fi
    export PATH=$PWD/.venv-release/$bin:$PATH
    maturin build "${options[@]}"
    for interpreter in ${FREE_THREADED-}; do
        case $interpreter in
            *3.14t) maturin build "${options[@]}" --interpreter "$interpreter" ;;
            *) maturin build "${options[@]}" --interpreter "$interpreter" --features pyo3/abi3t-py315 ;;
        esac
    done
}

# The wheel of dist/ that pip chooses for this machine, in an empty environment: it trains, verifies, saves and loads.
# pip looks for qtab in dist/ only.
installed() {
    local tried
    tried=$(mktemp -d)
    "$host_python" -m venv "$tried/venv"
    local pip=$tried/venv/$bin/pip
    "$pip" download --quiet --no-index --no-deps --find-links dist --dest "$tried/chosen" --only-binary :all: qtab
    "$pip" install --quiet --only-binary :all: "$tried"/chosen/qtab-*.whl
    echo "installed: $(ls "$tried/chosen"), $("$pip" list --format=freeze | sort | tr '\n' ' ')"
    (cd "$tried" && "./venv/$bin/python" -) <.ci/wheel.py || exit 1 # bash 3.2 goes on after a subshell that failed
    rm -rf "$tried"
}

# A wheel for Pyodide, which is Python in the browser, tried in Node. cibuildwheel downloads Emscripten and Pyodide.
pyodide() {
    "$host_python" -m venv .venv-pyodide
    .venv-pyodide/$bin/pip install --quiet cibuildwheel==4.3.5
    rustup target add wasm32-unknown-emscripten
    CIBW_TEST_COMMAND="python {project}/.ci/wheel.py" \
        .venv-pyodide/$bin/cibuildwheel --only cp314-pyodide_wasm32 --output-dir dist
}

# Writes the version of $TAG, such as v1.2.3, into the files that name it, and the address of $REPOSITORY into the links of
# the README, which PyPI shows. Without a tag they stay as they are.
version() {
    if [ -n "${TAG-}" ]; then
        "$host_python" .ci/version.py "$TAG"
        if [ -n "${REPOSITORY-}" ]; then
            "$host_python" .ci/links.py "$REPOSITORY" "$TAG"
        fi
    fi
}
