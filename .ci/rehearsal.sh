# A release rehearsed on this machine, for .ci/run, which sources this file.

# What PyPI checks; an upload to an index, which this task starts and ends; and for the lowest and the newest Python that is
# installed, an empty environment without Rust, into which pip installs qtab from that index and which runs the README's first
# Python code and the end of its first command. Then a notebook, as Google Colab and Binder would run it.
rehearsal() {
    built_wheel
    local tools=.venv-rehearsal/$bin version python newest found=()
    [ -d .venv-rehearsal ] || "$host_python" -m venv .venv-rehearsal
    $tools/pip install --quiet twine==7.0.0 pypiserver==2.4.2
    $tools/twine check --strict "$work"/dist/*
    start_index $tools/pypi-server
    $tools/twine upload --non-interactive --disable-progress-bar --username any --password any \
        --repository-url "$index" "$work"/dist/*
    for version in 3.10 3.11 3.12 3.13 3.14; do
        if python=$(interpreter $version); then
            found+=("$python")
        fi
    done
    [ ${#found[@]} -gt 0 ] || { echo "no Python of 3.10 to 3.14 is installed" && exit 1; }
    install_from_index "${found[0]}"
    newest=${found[${#found[@]} - 1]}
    [ "$newest" = "${found[0]}" ] || install_from_index "$newest"
    launched_notebooks "$newest"
    kill "$server"
    wait "$server" || true
    trap end_of_work EXIT
}

# Starts an index for everyone on this machine on a free port; sets $index, its address, and $server, its process.
start_index() {
    local port
    port=$("$host_python" -c 'import socket; s = socket.create_server(("127.0.0.1", 0)); print(s.getsockname()[1])')
    mkdir -p "$work/index"
    "$1" run --interface 127.0.0.1 --port "$port" --authenticate . --passwords . --disable-fallback "$work/index" &
    server=$!
    trap 'kill "$server" 2>/dev/null || true; end_of_work' EXIT
    index=http://127.0.0.1:$port
    "$host_python" - "$port" <<'END'
import socket, sys, time
for attempt in range(300):
    try:
        socket.create_connection(("127.0.0.1", int(sys.argv[1]))).close()
        break
    except ConnectionRefusedError:
        time.sleep(0.1)
else:
    sys.exit("the index has not started within 30 seconds")
END
}

# Installs qtab for one Python as a user does, without Rust; only qtab comes from the index, so that nothing else is looked up
# there. A shell of its own, because bash does not stop at errors in a function or a subshell whose result is tested.
install_from_index() {
    local tried programs line rust began=$SECONDS
    tried=$(mktemp -d "$work/rehearsal-XXXX")
    "$1" -m venv "$tried/.venv"
    programs=$tried/.venv/$bin
    for rust in cargo rustc; do
        printf '#!/bin/sh\nexit 1\n' >"$programs/$rust"
        chmod +x "$programs/$rust"
    done
    line=$(sed -n '/<!-- train -->/,/^```$/s/^python3 .* && \(.*\)$/\1/p' README.md)
    sed -n '/^```python$/,/^```$/p' README.md | sed -n '2,/^```$/{/^```$/!p;}' >"$tried/first.py"
    cat >"$tried/steps.sh" <<END
export PATH="$programs:\$PATH"
cd "$tried"
pip install --quiet --no-deps --only-binary :all: --index-url "$index/simple/" qtab
pip install --quiet --only-binary :all: "qtab[all]==\$(python -c 'from importlib.metadata import version; print(version("qtab"))')"
pip check
python first.py
${line//.venv\/bin\//.venv/$bin/}
END
    bash -euo pipefail "$tried/steps.sh"
    echo "installed from the index on $("$1" --version): $((SECONDS - began)) s"
}

# Runs a notebook as Google Colab does, where its first cell installs what it needs, and then as Binder does, which has
# installed its requirements before. Both share an environment that has a kernel of Jupyter, because installing takes most of
# the time. qtab itself comes from the index alone, and is there first, so that nothing looks it up elsewhere.
launched_notebooks() {
    local tried began=$SECONDS startup
    tried=$(mktemp -d "$work/notebooks-XXXX")
    "$1" -m venv "$tried/.venv"
    local pip=("$tried/.venv/$bin/pip" install --quiet --only-binary ":all:")
    "${pip[@]}" nbclient ipykernel
    "${pip[@]}" --no-deps --index-url "$index/simple/" qtab
    cp examples/chapters/chapter_2.ipynb "$tried/notebook.ipynb"
    startup=$tried/ipython/profile_default/startup
    mkdir -p "$startup"
    printf 'import sys, types\nsys.modules["google.colab"] = types.ModuleType("google.colab")\n' >"$startup/colab.py"
    run_notebook "$tried" || exit 1
    rm "$startup/colab.py"
    "${pip[@]}" -r .binder/requirements.txt
    run_notebook "$tried" || exit 1
    echo "a notebook as in Colab and in Binder: $((SECONDS - began)) s"
}

run_notebook() (
    cd "$1"
    PATH="$1/.venv/$bin:$PATH" IPYTHONDIR="$1/ipython" jupyter execute --timeout=600 notebook.ipynb
)
