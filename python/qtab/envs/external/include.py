"""The folder of the C header ``qtab_env.h``."""

from pathlib import Path


def get_include() -> str:
    """Returns the folder of ``qtab_env.h``, the C interface of environments, for the compiler's option ``-I``.

        cc -O2 -shared -fPIC -I"$(python -c 'import qtab; print(qtab.get_include())')" my_env.c -o libmy_env.so

    Returns:
        The absolute path.
    """
    return str(Path(__file__).resolve().parents[2] / "include")
