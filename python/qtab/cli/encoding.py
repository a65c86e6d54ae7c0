"""Output on terminals and in files whose encoding lacks Greek letters, as on Windows."""

import codecs
import sys
import unicodedata

HANDLER = "qtab.names"
"""The name of the error handler that writes letters as words."""
_SIGNS = {
    **{"≥": ">=", "≤": "<=", "←": "<-", "→": "->", "−": "-", "·": "*", "×": "x"},
    **{"±": "+-", "√": "sqrt ", "…": "...", "ᵀ": "^T"},
}


def write_names_of_letters() -> None:
    """Makes standard output and standard error write letters that their encoding lacks as words: ``alpha`` for α.

    Without it, the equations of ``qtab explain`` and the help of ``qtab train`` would raise UnicodeEncodeError.
    """
    codecs.register_error(HANDLER, _in_words)
    for stream in (sys.stdout, sys.stderr):
        # A stream that replaces one of these, as in tests, may have no encoding.
        if hasattr(stream, "reconfigure") and stream.errors in ("strict", "backslashreplace"):
            stream.reconfigure(errors=HANDLER)


def _in_words(error: UnicodeError) -> tuple[str, int]:
    if not isinstance(error, UnicodeEncodeError):
        raise error
    return "".join(map(_plain, error.object[error.start : error.end])), error.end


def _plain(letter: str) -> str:
    """Returns a character in ASCII: the name of a Greek letter, a similar sign, or a question mark."""
    name = unicodedata.name(letter, "")
    if name.startswith("GREEK"):
        word = name.split(" WITH ")[0].split()[-1].replace("LAMDA", "LAMBDA")  # Unicode spells it so
        return word.lower() if "SMALL" in name else word.capitalize()
    return _SIGNS.get(letter, "?")
