# A release rehearsed on this machine, for .ci/run, which sources this file.

# What PyPI checks; an upload to an index, which this task starts and ends; and for each Python that is installed, an empty
# environment without Rust, into which pip installs qtab from that index and which runs the README's first Python code and the
# end of its first command.
rehearsal() {
    built_wheel
    local tools=.venv-rehearsal/$bin version python
    [ -d .venv-rehearsal ] || "$host_python" -m venv .venv-rehearsal
    $tools/pip install --quiet twine==7.0.0 pypiserver==2.4.2
    $tools/twine check --strict "$work"/dist/*
    start_index $tools/pypi-server
    $tools/twine upload --non-interactive --disable-progress-bar --username any --password any \
        --repository-url "$index" "$work"/dist/*
    for version in 3.10 3.11 3.12 3.13 3.14; do
        if python=$(interpreter $version); then
            install_from_index "$python"
        else
            echo "skipped: python$version is not installed"
        fi
    done
    kill "$server"
}

# Starts an index for everyone on this machine on a free port; sets $index, its address, and $server, its process.
start_index() {
    local port
    port=$("$host_python" -c 'import socket; s = socket.create_server(("127.0.0.1", 0)); print(s.getsockname()[1])')
    mkdir -p "$work/index"
    "$1" run --interface 127.0.0.1 --port "$port" --authenticate . --passwords . --disable-fallback "$work/index" &
    server=$!
    trap 'kill $server 2>/dev/null; rm -rf "$work"' EXIT
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

# Installs qtab for one Python as a user does; only qtab comes from the index, so that nothing else is looked up there.
install_from_index() {
    local tried programs line began=$SECONDS
    tried=$(mktemp -d "$work/rehearsal-XXXX")
    "$1" -m venv "$tried/.venv"
    programs=$tried/.venv/$bin
    line=$(sed -n '/<!-- train -->/,/^```$/s/^python3 .* && \(.*\)$/\1/p' README.md)
    line=${line//.venv\/bin\//.venv/$bin/}
    sed -n '/^```python$/,/^```$/p' README.md | sed -n '2,/^```$/{/^```$/!p;}' >"$tried/first.py"
    (
        export PATH="$programs:/usr/bin:/bin"
        ! type -P cargo || { echo "Rust is in the way" && exit 1; }
        pip install --quiet --no-deps --only-binary :all: --index-url "$index/simple/" qtab
        pip install --quiet --only-binary :all: 'qtab[all]'
        pip check
        cd "$tried"
        python first.py
        echo "$line"
        bash -euc "$line" | tail -n 3
    ) || exit 1
    echo "installed from the index on $("$1" --version): $((SECONDS - began)) s"
}
