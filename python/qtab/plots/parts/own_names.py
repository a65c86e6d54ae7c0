"""The names of actions that an environment of the user has."""

from contextlib import closing

from qtab.envs.registry import entry_for_id, is_registered
from qtab.plots.parts.subject import Subject
from qtab.results.run import Run
from qtab.results.runs import Runs
from qtab.results.words import own_action_names
from qtab.training.setup.run_env import make_run_env


def environment_action_names(subject: Subject) -> tuple[str, ...]:
    """Returns the names of the actions: those of the attribute ``action_names`` of a user's environment, if it has one.

    Only an environment with an id can be asked, because it has to be made again.
    """
    known, source = subject.action_names, subject.source
    if not isinstance(source, Run | Runs) or not is_registered(subject.env) or entry_for_id(subject.env) is not None:
        return known
    try:
        with closing(make_run_env(source.config)) as env:
            return own_action_names(env, known)
    except Exception:  # it cannot be made again, and names are only decoration
        return known
