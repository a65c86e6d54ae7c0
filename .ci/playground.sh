# The playground's tools, as .ci/run needs them: WebAssembly for Rust, and Chromium.

# Ends a task early where this machine lacks something that cannot be had; an error where QTAB_REQUIRE_ALL=1, as in the
# workflows.
skipped() {
    echo "skipped: $1"
    [ "${QTAB_REQUIRE_ALL:-}" != 1 ] || exit 1
}

# Whether Rust compiles for WebAssembly here, after rustup was asked for it. (Debian's rustc-web 1.85 with rust-web-src
# does not: Cargo.toml's rust-version is newer.)
wasm_target() {
    (cd rust/web && "$host_python" -c 'import sys, build_backend; sys.exit(not build_backend.add_target())')
}
no_wasm="Rust's target wasm32-unknown-unknown is missing, rustup cannot add it, and Debian's rustc-web 1.85 is older than \
$(sed -n 's/^rust-version = "\(.*\)"/\1/p' Cargo.toml)"

# Builds qtab.wasm where that is possible; the wheel then holds the playground.
wasm_module() {
    if wasm_target; then
        "$host_python" rust/web/build_backend.py
        export QTAB_PLAYGROUND=1
    else
        skipped "the playground: $no_wasm"
    fi
}

# Installs a package of Debian where that is possible.
debian_package() {
    local sudo=
    [ "$(id -u)" = 0 ] || sudo=sudo
    { $sudo apt-get update --quiet=2 || true; } && $sudo apt-get install --yes --quiet "$1"
}

# Sets CHROMIUM to the browser's program, which apt-get installs if there is none.
find_chromium() {
    export CHROMIUM=${CHROMIUM:-$(type -P chromium || type -P chromium-browser || type -P google-chrome || true)}
    [ -n "$CHROMIUM" ] || { debian_package chromium && CHROMIUM=$(type -P chromium); }
}

# The playground in Chromium: the module built anew, its tables compared with Python's, the page's controls.
playground() {
    tools
    wasm_module
    [ "${QTAB_PLAYGROUND:-}" = 1 ] || return 0
    if ! find_chromium; then
        skipped "the tests of the page: there is no Chromium, and apt-get cannot install it"
        return 0
    fi
    .venv/$bin/pip install --quiet '.[browser]'
    .venv/$bin/python -m pytest -n 0 -m browser tests/playground
}
