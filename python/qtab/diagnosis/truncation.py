"""Truncation: time-outs that are treated as terminal states."""

from qtab.config.options import fixed_settings
from qtab.diagnosis.changes import changes
from qtab.diagnosis.facts import Facts
from qtab.diagnosis.finding import Finding, percent


def truncation(facts: Facts) -> Finding | None:
    """Finds time-outs that are treated as terminal states."""
    timed_out = int((~facts.run.terminated).sum())
    if facts.config.on_truncation != "terminate" or facts.config.time_aware or timed_out == 0:
        return None
    if "on_truncation" in fixed_settings(facts.config.algorithm):
        return None
    share = timed_out / len(facts.run.terminated)
    return Finding(
        name="time-outs treated as terminal",
        title="Time-outs are treated as terminal states.",
        evidence={"episodes that timed out": timed_out, "share of all episodes": share},
        meaning=f"{percent(share)} of the episodes end by the time limit. The state where that happens depends on the "
        "clock, which the agent does not see, and its value is learned as if nothing followed.",
        advice="use on_truncation='bootstrap': the value of the last state then counts",
        changes=changes(facts.config, {"on_truncation": "bootstrap"}),
    )
