"""The subcommands of ``qtab``, one a file: the arguments in ``parser()``, and what it does in ``run(arguments)``."""
