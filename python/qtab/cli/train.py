"""``qtab train``."""

from qtab._utils.shown import counted
from qtab.cli.outputs import Outputs
from qtab.cli.reporting import Report
from qtab.cli.settings import with_initial_q
from qtab.cli.train_arguments import COMMAND, flags_of, parse_arguments
from qtab.cli.training_report import Training, backend_words, optimum_of
from qtab.cli.usage import usage_errors
from qtab.results.snapshots import snapshot_episodes
from qtab.training.resolve import resolve, time_limit_notice
from qtab.training.resolved_run import ResolvedRun


def run(arguments: list[str]) -> int:
    """Trains and reports; returns the exit code."""
    asked, env, settings = parse_arguments(arguments)
    flags = flags_of(asked)
    with Report(COMMAND, asked) as report:
        with usage_errors(flags, "env"):
            resolved = resolve(env, with_initial_q(settings))
        try:
            with usage_errors(flags, "env"):
                outputs = Outputs(
                    resolved.config, asked.save, asked.plot, asked.watch, asked.record, report.text, asked.checkpoint
                )
                snapshots = snapshot_episodes(asked.snapshots, resolved.config.episodes)
                best = optimum_of(resolved, asked.optimum, report.progress)
            report.writes_files = outputs.has_files
            with outputs:
                report.text(_header(resolved))
                Training(resolved, report, outputs, best, asked.visits, snapshots).run()
        finally:
            resolved.close()
    return 0


def _header(resolved: ResolvedRun) -> str:
    config = resolved.config
    parts = [
        backend_words(config),
        f"preset {config.preset}" if config.preset is not None else "no preset",
        counted(config.episodes, "episode"),
        f"seed {config.seed}",
    ]
    header = ", ".join(parts)
    return f"{header}\n{time_limit_notice(resolved)}" if resolved.default_time_limit else header
