"""``qtab playground`` and the files that it writes."""

import base64
import gzip
import json
import posixpath
import re
import webbrowser
from pathlib import Path

import pytest

import qtab
import qtab.playground.assemble
from qtab import playground
from qtab.cli import main
from qtab.playground.bundle import bundle
from support.playground import PATIENCE

MODULE = Path(qtab.playground.assemble.__file__).parent / "page/qtab.wasm"
# Of the page in one file, and of what a server that compresses it sends.
MOST_BYTES, MOST_BYTES_SENT = 500_000, 300_000
needs_module = pytest.mark.skipif(not MODULE.exists(), reason="needs qtab.wasm: python rust/web/build_backend.py")


@pytest.fixture
def opened(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """The addresses that a browser was asked to open."""
    addresses: list[str] = []

    def record(address: str) -> bool:
        addresses.append(address)
        return True

    monkeypatch.setattr(webbrowser, "open", record)
    return addresses


@needs_module
def test_the_command_writes_one_file_and_opens_it(tmp_path, opened, capsys):
    path = tmp_path / "page.html"
    assert main(["playground", "--out", str(path)]) == 0
    assert opened == [path.as_uri()]
    assert capsys.readouterr().out == f"Saved the playground to {path}\n"
    html = path.read_text(encoding="utf-8")
    assert html == playground.page()
    module = re.search(r'"wasm":"([^"]*)"', html)
    assert module is not None
    assert gzip.decompress(base64.b64decode(module[1])) == MODULE.read_bytes()
    texts = re.search(r'"packed":"([^"]*)"', html)
    assert texts is not None
    data = json.loads(gzip.decompress(base64.b64decode(texts[1])))
    assert data["definitions"] == json.loads(json.dumps(playground.definitions()))
    sources = qtab.playground.assemble._sources()
    assert (data["script"], data["worker"]) == (bundle(sources, "main.js"), bundle(sources, "worker.js"))
    assert not [line for line in html.splitlines() if 'src="' in line or '<link rel="stylesheet' in line]


@needs_module
def test_the_page_is_small():
    html = playground.page().encode()
    assert len(html) < MOST_BYTES
    assert len(gzip.compress(html)) < MOST_BYTES_SENT


@needs_module
def test_without_opening_nothing_is_opened(tmp_path, opened):
    assert main(["playground", "--out", str(tmp_path / "page.html"), "--no-open"]) == 0
    assert opened == []


@needs_module
def test_a_folder_that_does_not_exist_is_an_error_in_one_line(tmp_path, opened, capsys):
    assert main(["playground", "--out", str(tmp_path / "none/page.html")]) == 2
    message = capsys.readouterr().err
    assert message.startswith("qtab playground: error: --out must be a file that can be written, got ")
    assert message.count("\n") == 1
    assert opened == []


@pytest.mark.parametrize("in_a_checkout", [True, False])
def test_without_the_module_the_error_says_how_to_build_it(tmp_path, opened, capsys, monkeypatch, in_a_checkout):
    monkeypatch.setattr(qtab.playground.assemble, "MODULE", "missing.wasm")
    monkeypatch.setattr(qtab.playground.assemble, "__file__", str(tmp_path / "python/qtab/playground/assemble.py"))
    build = tmp_path / "rust/web/build_backend.py"
    if in_a_checkout:
        build.parent.mkdir(parents=True)
        build.touch()
    assert main(["playground", "--out", str(tmp_path / "page.html")]) == 1
    message = capsys.readouterr().err
    remedy = f"python {build}" if in_a_checkout else "pip install --force-reinstall --no-deps ."
    assert message.endswith(f"rustup target add wasm32-unknown-unknown && {remedy}\n")
    assert message.count("\n") == 1
    assert not (tmp_path / "page.html").exists()


@needs_module
@pytest.mark.browser
@pytest.mark.parametrize("requested_while_loading", [False, True])
def test_a_module_of_another_version_is_refused(tmp_path, chromium, requested_while_loading, monkeypatch):
    of_another = {**playground.definitions(), "version": "9.9.9"}
    monkeypatch.setattr(qtab.playground.assemble, "definitions", lambda: of_another)
    page = chromium.new_page()
    page.set_default_timeout(PATIENCE)
    if requested_while_loading:
        instantiate = "const { instance, module: ready } = await WebAssembly"
        later = f"await new Promise((done) => setTimeout(done, 1000)); {instantiate}"
        assert bundle(qtab.playground.assemble._sources(), "worker.js").count(instantiate) == 1
        monkeypatch.setattr(
            qtab.playground.assemble, "bundle", lambda *given: bundle(*given).replace(instantiate, later)
        )
        page.add_init_script(
            "const post = Worker.prototype.postMessage; Worker.prototype.postMessage = function (message, ...rest) "
            "{ setTimeout(() => post.call(this, message, ...rest), message.type === 'load' ? 0 : 200); };"
        )
    path = tmp_path / "page.html"
    path.write_text(playground.page(), encoding="utf-8")
    page.goto(path.as_uri())
    problem = page.locator("#problem")
    problem.wait_for()
    assert problem.inner_text() == (
        f"qtab.wasm is {qtab.__version__}, and the page 9.9.9: rebuild it with python rust/web/build_backend.py"
    )
    page.close()


@needs_module
def test_a_site_holds_the_modules_and_the_definitions_as_files(tmp_path):
    playground.write_site(tmp_path / "site")
    site = tmp_path / "site"
    written = {file.relative_to(site).as_posix() for file in site.rglob("*") if file.is_file()}
    assert {"index.html", "style.css", "main.js", "engine.js", "worker.js", "definitions.js", "qtab.wasm"} <= written
    for name in (name for name in written if name.endswith(".js")):
        imported = re.findall(r'from "(\.[^"]*)"', (site / name).read_text(encoding="utf-8"))
        assert {posixpath.normpath(posixpath.join(posixpath.dirname(name), path)) for path in imported} <= written
    text = (tmp_path / "site/definitions.js").read_text(encoding="utf-8")
    data = json.loads(text.removeprefix("globalThis.QTAB_PLAYGROUND = ").removesuffix(";\n"))
    assert data == {"definitions": json.loads(json.dumps(playground.definitions()))}
    html = (tmp_path / "site/index.html").read_text(encoding="utf-8")
    assert html.index("definitions.js") < html.index("main.js")


SOURCES = {
    "main.js": 'import { a, b as c } from "./part.js";\nimport "./side.js";\nexport const d = a + c;\n',
    "part.js": "export const a = 1;\nexport function b() {}\nclass Hidden {}\n",
    "side.js": "globalThis.seen = true;\n",
    "unused.js": "export default 1;\n",
}


def test_modules_become_one_script_in_the_order_of_their_imports():
    script = bundle(SOURCES, "main.js")
    assert script.index("const a = 1;") < script.index("const { a, b: c } = modules['part.js'];")
    assert script.index("globalThis.seen") < script.index("const d = a + c;")
    assert "return { a, b };" in script
    assert "import" not in script
    assert "export" not in script


def test_an_import_is_relative_to_the_folder_of_its_module():
    sources = {"a/b.js": 'import { c } from "../c.js";\n', "c.js": 'import { d } from "./a/d.js";\n', "a/d.js": ""}
    script = bundle(sources, "a/b.js")
    assert script.index("modules['a/d.js'] =") < script.index("const { d } = modules['a/d.js'];")
    assert script.index("modules['c.js'] =") < script.index("const { c } = modules['c.js'];")


def test_lines_of_comments_are_left_out_and_no_others():
    code = [
        'const url = "http://a"; // kept',
        "const product = 2 /* kept */ * 3;",
        "let [a, b] = [1, 2];",
        "a /** b */ * b;",
    ]
    comments = ["// one", "  // two", "/** three */", "  /**\n   * four * five\n   */"]
    lines = [line for pair in zip(comments, code, strict=True) for line in pair]
    script = bundle({"main.js": "\n".join(lines) + "\n"}, "main.js")
    assert "\n".join(code) in script
    assert "one" not in script
    assert "four" not in script


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"part.js": 'import { d } from "./main.js";\n'}, "modules import each other in a circle"),
        ({"side.js": "export default 1;\n"}, "side.js: 'export default 1;' is not a form of import or export"),
        ({"side.js": 'import x from "./part.js";\n'}, "is not a form of import or export that can be bundled"),
        ({"main.js": 'import { a } from "./parts.js";\n'}, "the module parts.js is missing"),
        ({"side.js": "const text = `one\n  two`;\n"}, "side.js: 'const text = `one' begins or ends a text that spans"),
    ],
)
def test_modules_that_cannot_be_bundled_are_refused(changed, message):
    with pytest.raises(ValueError, match=message):
        bundle({**SOURCES, **changed}, "main.js")
