"""Makes the links of the README absolute, so that pictures show on PyPI and pages are found from there, adds links that
open its notebooks in Google Colab and Binder, and writes the repository into the manifests of the crates.

    python .ci/links.py https://github.com/OWNER/NAME v1.2.3

The links of the README are relative, because no file contains the address of the repository: a release passes it.
"""

import re
import sys
from pathlib import Path

from launch import launch

README = Path(__file__).parents[1] / "README.md"
MANIFESTS = [Path(__file__).parents[1] / "rust" / crate / "Cargo.toml" for crate in ("core", "env")]
LINK = re.compile(r"(!?)\[([^\]]*)\]\((?!https?:|#)([^)\s]+)\)")


def main(repository: str, tag: str) -> None:
    """Rewrites the README and the manifests."""
    if not re.fullmatch(r"https://[\w.-]+/[\w.-]+/[\w.-]+", repository):
        sys.exit(f"the repository must be like https://github.com/OWNER/NAME, got {repository!r}")

    def absolute(link: "re.Match[str]") -> str:
        picture, text, target = link.groups()
        made = f"{picture}[{text}]({repository}/{'raw' if picture else 'blob'}/{tag}/{target})"
        opened = launch(repository, tag, target) if target.endswith(".ipynb") else {}
        return made + "".join(f" [{name}]({address})" for name, address in opened.items())

    text, count = LINK.subn(absolute, README.read_text(encoding="utf-8"))
    README.write_text(text, encoding="utf-8", newline="\n")
    print(f"{count} links of README.md lead to {repository}")
    for path in MANIFESTS:
        manifest = path.read_text(encoding="utf-8")
        if "\nrepository = " not in manifest:
            manifest = manifest.replace("\ndocumentation = ", f'\nrepository = "{repository}"\ndocumentation = ', 1)
            path.write_text(manifest, encoding="utf-8", newline="\n")


if __name__ == "__main__":
    main(*sys.argv[1:])
