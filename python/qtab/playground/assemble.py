"""Assembles the playground: one self-contained HTML file, or the files of a site."""

import base64
import gzip
import json
from collections.abc import Iterator
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING, Any

from qtab.playground.bundle import bundle
from qtab.playground.definitions import definitions

if TYPE_CHECKING:
    from importlib.resources.abc import Traversable  # Python 3.11 and later

MODULE = "qtab.wasm"
STYLE = '<link rel="stylesheet" href="style.css">'
SCRIPT = '<script type="module" src="main.js"></script>'
# The page cannot send any request: not for scripts, styles, pictures or data.
POLICY = (
    "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; script-src 'unsafe-inline' "
    "'wasm-unsafe-eval' blob:; style-src 'unsafe-inline'; img-src data: blob:; worker-src blob:; base-uri 'none'; "
    "form-action 'none'\">"
)
# Starts the script of a page in one file.
UNPACK = """\
const data = globalThis.QTAB_PLAYGROUND;
if (!globalThis.DecompressionStream) {
  document.querySelector("#status").textContent = "This browser cannot decompress the page: a newer version can.";
}
const bytes = Uint8Array.from(atob(data.packed), (letter) => letter.charCodeAt(0));
const unpacked = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
Object.assign(data, JSON.parse(await new Response(unpacked).text()));
delete data.packed;
document.body.append(Object.assign(document.createElement("script"), { type: "module", textContent: data.script }));
"""


def page() -> str:
    """Returns the playground as one HTML file, with the WebAssembly module inside.

    Raises:
        FileNotFoundError: if the module was not built; the message explains how to build it.
    """
    sources = _sources()
    html = _text("index.html")
    for line in (STYLE, SCRIPT):
        if line not in html:
            raise ValueError(f"index.html must hold the line {line}")
    style = f"<style>\n{_text('style.css')}\n</style>"
    html = html.replace(STYLE, f"{POLICY}\n{style}")
    return html.replace(SCRIPT, packed(bundle(sources, "main.js"), bundle(sources, "worker.js")))


def packed(script: str, worker: str) -> str:
    """Returns the scripts of a page in one file, which start ``script`` with all that engine.js would otherwise load.

    The module, the definitions and both scripts are compressed by gzip: together they take less than half of the space.
    """
    texts = _json({"worker": worker, "definitions": definitions(), "script": script}).encode()
    data = {"wasm": _compressed(wasm()), "packed": _compressed(texts)}
    return f'<script>globalThis.QTAB_PLAYGROUND = {_json(data)};</script>\n<script type="module">\n{UNPACK}</script>'


def _compressed(data: bytes) -> str:
    return base64.b64encode(gzip.compress(data, mtime=0)).decode()


def write_site(folder: Path) -> None:
    """Writes the playground as separate files, for a site: index.html, the modules, the definitions, qtab.wasm.

    Raises:
        FileNotFoundError: if the WebAssembly module was not built; the message explains how to build it.
    """
    module = wasm()
    folder.mkdir(parents=True, exist_ok=True)
    data = '<script src="definitions.js"></script>'
    (folder / "index.html").write_text(_text("index.html").replace(SCRIPT, f"{data}\n{SCRIPT}"), encoding="utf-8")
    (folder / "style.css").write_text(_text("style.css"), encoding="utf-8")
    for name, source in _sources().items():
        (folder / name).parent.mkdir(exist_ok=True)
        (folder / name).write_text(source, encoding="utf-8")
    known = f"globalThis.QTAB_PLAYGROUND = {_json({'definitions': definitions()})};\n"
    (folder / "definitions.js").write_text(known, encoding="utf-8")
    (folder / "qtab.wasm").write_bytes(module)


def wasm() -> bytes:
    """Returns the WebAssembly module.

    Raises:
        FileNotFoundError: if the module was not built; the message explains how to build it.
    """
    try:
        return (_folder() / MODULE).read_bytes()
    except FileNotFoundError:
        raise FileNotFoundError(
            "this installation of qtab has no WebAssembly module, because Rust's target wasm32-unknown-unknown was "
            f"missing when it was installed; {_remedy()}"
        ) from None


def _remedy() -> str:
    """Says how this installation, in a checkout or elsewhere, gets its module."""
    build = Path(__file__).resolve().parents[3] / "rust/web/build_backend.py"
    if build.exists():
        return f"build it with: rustup target add wasm32-unknown-unknown && python {build}"
    return (
        "in the clone that it came from, run: rustup target add wasm32-unknown-unknown && "
        "pip install --force-reinstall --no-deps ."
    )


def _folder() -> "Traversable":
    return files("qtab.playground") / "page"


def _text(name: str) -> str:
    return (_folder() / name).read_text(encoding="utf-8")


def _sources() -> dict[str, str]:
    """The text of each module by its path."""
    return dict(_modules_in(_folder(), ""))


def _modules_in(folder: "Traversable", path: str) -> Iterator[tuple[str, str]]:
    for file in folder.iterdir():
        if file.is_dir():
            yield from _modules_in(file, f"{path}{file.name}/")
        elif file.name.endswith(".js"):
            yield f"{path}{file.name}", file.read_text(encoding="utf-8")


def _json(data: Any) -> str:
    """JSON that is safe inside a script of a page."""
    return json.dumps(data, ensure_ascii=False, allow_nan=False, separators=(",", ":")).replace("<", "\\u003c")
