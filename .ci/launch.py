"""The addresses at which Google Colab and Binder open a notebook of the repository.

Colab runs the notebook as it is stored; its first cell of code installs qtab there. Binder installs
``.binder/requirements.txt``.
"""

from urllib.parse import quote

GITHUB = "https://github.com/"


def launch(repository: str, ref: str, path: str) -> dict[str, str]:
    """Returns the addresses by name, for a tag or a branch and a path; none for a repository outside of GitHub."""
    if not repository.startswith(GITHUB):
        return {}
    name = repository.removeprefix(GITHUB)
    return {
        "Colab": f"https://colab.research.google.com/github/{name}/blob/{ref}/{path}",
        "Binder": f"https://mybinder.org/v2/gh/{name}/{quote(ref, safe='')}?labpath={quote(path, safe='')}",
    }
