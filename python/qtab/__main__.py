"""``python -m qtab``: the ``qtab`` command of the interpreter at hand."""

import sys

from qtab.cli import main

sys.exit(main())
