"""Opens every page of the built site in Chromium: nothing is loaded from elsewhere, and the console shows no error.

Blocks of code fit into their boxes in a window of 1,400 pixels.

A page without external addresses may still load things through its scripts, which only a browser detects.
"""

import functools
import http.server
import os
import shutil
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

CHROMIUM = os.environ.get("CHROMIUM") or shutil.which("chromium") or shutil.which("google-chrome")
NOTEBOOKS = "notebooks/"
"""The pages of notebooks, whose code has lines of up to 120 letters."""
TOO_WIDE = """() => [...document.querySelectorAll(".bd-article div.highlight pre")]
    .map(block => block.scrollWidth - block.clientWidth).filter(pixels => pixels > 1)"""
"""Returns by how many pixels each block of code of a page is wider than its box."""
PATIENCE = 300_000
"""What a busy machine may take for anything in the browser, in milliseconds."""
NO_NETWORK = "--host-resolver-rules=MAP * ~NOTFOUND, EXCLUDE 127.0.0.1"


class Quiet(http.server.SimpleHTTPRequestHandler):
    """Serves files without logging the requests."""

    def log_message(self, format: str, *arguments: Any) -> None:  # noqa: A002 - the name in the standard library
        """Prints nothing."""


class Server(http.server.ThreadingHTTPServer):
    """Ignores early disconnects."""

    def handle_error(self, request: Any, client_address: Any) -> None:
        """Prints nothing."""


@contextmanager
def served(site: Path) -> Iterator[str]:
    """Serves a folder on this machine, as the site will be served; yields its address."""
    handler = functools.partial(Quiet, directory=str(site))
    with Server(("127.0.0.1", 0), handler) as server:
        thread = threading.Thread(target=server.serve_forever, daemon=True)
        thread.start()
        try:
            yield f"http://127.0.0.1:{server.server_port}/"
        finally:
            server.shutdown()
            thread.join()


@contextmanager
def browsed(site: Path) -> Iterator[tuple[Any, str]]:
    """Serves a folder and starts Chromium; yields an empty page and the address of the folder."""
    from playwright.sync_api import sync_playwright

    with served(site) as address, sync_playwright() as playwright:
        options = {"executable_path": CHROMIUM, "args": ["--no-sandbox", NO_NETWORK], "timeout": PATIENCE}
        browser = playwright.chromium.launch(**options)
        page = browser.new_page(viewport={"width": 1400, "height": 900})
        page.set_default_timeout(PATIENCE)
        yield page, address
        browser.close()


def problems(site: Path) -> list[str]:
    """Returns a line for each external request, failed request and error on the console."""
    if CHROMIUM is None:
        return ["no browser: install Chromium, or set CHROMIUM to its path"]

    found: list[str] = []
    with browsed(site) as (page, address):
        opened = ""

        def note(text: str) -> None:
            found.append(f"{opened}: {text}")

        page.on("request", lambda request: _is_ours(request.url, address) or note(f"asks {request.url}"))
        page.on("response", lambda response: response.status < 400 or note(f"{response.status} {response.url}"))
        page.on("console", lambda message: message.type == "error" and note(f"console: {message.text}"))
        page.on("pageerror", lambda error: note(f"error: {error}"))
        for path in sorted(site.rglob("*.html")):
            opened = path.relative_to(site).as_posix()
            page.goto(address + opened, wait_until="load")
            if not opened.startswith(NOTEBOOKS):
                for pixels in page.evaluate(TOO_WIDE):
                    note(f"code is {pixels} px wider than its box")
    return list(dict.fromkeys(found))


def _is_ours(url: str, address: str) -> bool:
    return url.startswith((address, "data:", "blob:", "about:"))
