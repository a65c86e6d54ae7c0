"""Continue a saved run exactly where it stopped, or train a finished one for more episodes."""

from argparse import Namespace
from contextlib import closing
from pathlib import Path

from qtab.cli.errors import usage_errors
from qtab.cli.outputs import Outputs
from qtab.cli.parser import Parser
from qtab.cli.reporting import Report
from qtab.cli.saved_run import ENV_OF_RUN, add_run, load_run
from qtab.cli.training_report import OPTIMUM, Training, backend_words, optimum_of
from qtab.cli.values import integer
from qtab.config.merge import over
from qtab.results.run import Run
from qtab.training.callbacks import TrainingOptions
from qtab.training.earlier_run import check_agrees, counts_visits, has_finished, resolve_again, snapshots_of
from qtab.training.setup.resolve import resolve
from qtab.training.setup.resolved_run import ResolvedRun


def add_arguments(parser: Parser) -> None:
    """Adds the arguments of the command."""
    add_run(parser)
    parser.output_flags()
    episodes = "The number of episodes of the whole run, including the finished ones; by default that of the run. "
    episodes += "With more, a falling epsilon is spread over all of them, and therefore rises again at first."
    parser.option("episodes", integer, episodes)
    save = "Save the run to this file; by default to RUN, which is replaced. Ctrl-C saves what was learned so far."
    parser.option("save", Path, save)
    every = "Save the run so far, to the same file as the result, each time this many more episodes are finished."
    parser.option("checkpoint", integer, every, metavar="EPISODES")
    parser.option("plot", Path, "Draw the learning curve of the whole run to this file; its suffix sets the format.")
    snapshots = "Keep this many copies of the tables, evenly spaced over the whole run, besides those of RUN."
    parser.option("snapshots", integer, snapshots)
    parser.option("env", str, ENV_OF_RUN, metavar="ENV")
    parser.switch("optimum", OPTIMUM)
    parser.set_defaults(watch=None, record=None)  # options of qtab train only


def run(asked: Namespace) -> int:
    """Runs the command and returns its exit code."""
    with Report(asked) as report:
        with usage_errors(asked):
            earlier = load_run(asked)
            check_agrees(earlier, asked.env, {})
            visits = counts_visits(earlier, False)
            options = TrainingOptions(visits=visits, snapshots=asked.snapshots)
            finished = has_finished(earlier, asked.episodes, options)
            if finished:
                resolved = resolve(earlier.config.env, over(earlier.config, {}))
            else:
                resolved = resolve_again("run", earlier, asked.episodes, None)
        with closing(resolved):
            with usage_errors(asked):
                if finished:
                    asked.checkpoint = None
                elif asked.save is None:
                    asked.save = asked.run
                outputs = Outputs(resolved.config, asked, report)
                snapshots = snapshots_of(options, resolved.config.episodes, earlier)
                best = optimum_of(resolved, asked.optimum, report.progress)
            with outputs:
                report.text(_header(earlier, resolved))
                wanted = tuple(number for number in snapshots if number > len(earlier.episode_returns))
                training = Training(resolved, report, outputs, best, visits, wanted, earlier)
                if finished:
                    training.keep_and_report(earlier)
                else:
                    training.run()
    return 0


def _header(earlier: Run, resolved: ResolvedRun) -> str:
    config = resolved.config
    done = f"resumed after {len(earlier.episode_returns):,} of {config.episodes:,} episodes"
    return f"{backend_words(config)}, {done}, seed {config.seed}"
