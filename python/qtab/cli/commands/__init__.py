"""The subcommands of ``qtab``, one a file: ``add_arguments(parser)``, and ``run(options) -> exit code``."""
