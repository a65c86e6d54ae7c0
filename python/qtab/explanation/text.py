"""An explanation as plain text and as an HTML table."""

from collections.abc import Sequence

from qtab._utils.html import sentences
from qtab.explanation.equations import number
from qtab.explanation.policy_update import PolicyUpdate
from qtab.explanation.records import ExplainedStep, Update

SHOWN_ROWS = 4
"""With more active rows, only the first ones are listed."""
SHOWN_PLANNING = 10
"""With more planning updates, only the first ones are listed."""
COLUMNS = ("step", "state", "action", "why", "reward", "target", "TD error", "before", "after", "equation")


def text(heading: str, steps: Sequence[ExplainedStep]) -> str:
    """Returns a block of lines for each step."""
    blocks = [heading]
    for step in steps:
        lines = details(step)
        width = max(len(name) for name, _ in lines)
        blocks.append("\n".join([f"step {step.step}", *(f"  {name:{width}}  {line}" for name, line in lines)]))
    return "\n\n".join(blocks)


def html(heading: str, steps: Sequence[ExplainedStep]) -> str:
    """Returns a table with a row for each step."""
    return sentences(heading, COLUMNS, [_cells(step) for step in steps])


def details(step: ExplainedStep) -> list[tuple[str, str]]:
    """Returns the lines of a step, each with its label."""
    lines = [
        ("state", f"{step.state}; {place(step.rows, step.cell, step.features)}"),
        ("action", f"{step.action_name}; values {_values(step)}"),
        ("why", str(step.choice)),
        ("reward", f"{step.reward_text}, then {step.next_state}; {ending(step)}"),
    ]
    if step.future_return is not None:
        lines.append(("return", f"G = {number(step.future_return)}, the discounted rewards from here on"))
    for update in step.updates:
        lines += update_lines(step, update)
    for change in step.policy_updates:
        lines += policy_lines(change)
    if step.note:
        lines.append(("update", step.note + (f"; waiting: {steps_waiting(step)}" if step.pending else "")))
    elif step.pending:
        lines.append(("waiting", steps_waiting(step)))
    if step.n_traces:
        for trace in step.traces:
            values = f"z = {number(trace.trace)}, {number(trace.before)} -> {number(trace.after)}"
            lines.append(("trace", f"{trace.state}, {trace.action_name}: {values}"))
        if step.n_traces > len(step.traces):
            lines.append(("trace", f"and {step.n_traces - len(step.traces)} more"))
    for update in step.planning[:SHOWN_PLANNING]:
        lines.append(("planning", f"{update.state}, {update.action_name}: {update.numbers[-1]}"))
    if len(step.planning) > SHOWN_PLANNING:
        lines.append(("planning", f"and {len(step.planning) - SHOWN_PLANNING} more"))
    return lines


def _values(step: ExplainedStep) -> str:
    """Returns the values that the policy compared, each after the name of its action if it has one."""
    named = zip(step.action_names, step.choice.values, strict=False)
    if not step.action_names or step.action_names[0] == "action 0":
        return ", ".join(number(value) for value in step.choice.values)
    return ", ".join(f"{name} {number(value)}" for name, value in named)


def policy_lines(update: PolicyUpdate) -> list[tuple[str, str]]:
    """Returns the lines of an update of preferences: its equations, with their numbers below, and the policy."""
    lines = []
    names = ("error", "update")[-len(update.equations) :]
    for name, symbols, numbers in zip(names, update.equations, update.numbers, strict=True):
        lines += [(name, symbols), ("", numbers)]
    lines.append(("policy", update.policy))
    if update.value_before is not None and update.value_after is not None:
        lines.append(("state value", f"v(S): {number(update.value_before)} -> {number(update.value_after)}"))
    return lines


def update_lines(step: ExplainedStep, update: Update) -> list[tuple[str, str]]:
    """Returns the lines of an update: its equations, with their numbers below."""
    name = "update" if update.step == step.step else f"update of step {update.step}"
    lines = []
    if update.step == -1:
        lines, name = [("update", "of the last step of the episode before:")], ""
    for symbols, numbers in zip(update.equations, update.numbers, strict=True):
        lines += [(name, symbols), ("", numbers)]
        name = ""
    lines.append(
        (
            "value",
            f"{number(update.before)} -> {number(update.after)}, TD error {number(update.error)}"
            if not update.assigned
            else f"{number(update.before)} -> {number(update.after)}, assigned at the terminal state",
        )
    )
    return lines


def place(rows: Sequence[int], cell: tuple[int, ...] | None, features: Sequence[float] = ()) -> str:
    """Returns the cell of a state, its active rows, or its weighted features."""
    if cell is not None:
        return f"cell {cell[0]}" if len(cell) == 1 else f"cell ({', '.join(map(str, cell))})"
    if len(rows) == 1 and not features:
        return f"row {rows[0]}"
    more = ", ..." if len(rows) > SHOWN_ROWS else ""
    if features:
        return f"features {', '.join(map(number, features[:SHOWN_ROWS]))}{more}"
    return f"rows {', '.join(map(str, rows[:SHOWN_ROWS]))}{more}"


def ending(step: ExplainedStep) -> str:
    """Describes the kind of the next state, and whether the episode ended."""
    if step.terminated:
        return "a terminal state"
    where = place(step.next_rows, step.next_cell, step.next_features)
    if not step.truncated:
        return where
    return f"{where}; the time limit ends the episode" + (", and counts as a terminal state" if step.terminal else "")


def steps_waiting(step: ExplainedStep) -> str:
    """Describes the steps that an n-step method has not updated yet."""
    first, last = step.pending[0], step.pending[-1]
    return f"step {first}" if first == last else f"steps {first} to {last}"


def _cells(step: ExplainedStep) -> list[str]:
    """Returns the cells of a step's row in HTML. The equation's cell also has traces and planning updates."""
    update = step.first_update
    numbers = ["", "", "", ""]
    if update is not None:
        numbers = [number(value) for value in (update.target, update.error, update.before, update.after)]
    for change in step.policy_updates:
        numbers = [number(value) for value in (change.target, change.error, *change.preferences)]
    lines = details(step)[4:]
    equation = "\n".join(f"{name}: {line}" if name else line for name, line in lines)
    state = f"{step.state}; {place(step.rows, step.cell, step.features)}"
    return [str(step.step), state, step.action_name, str(step.choice), number(step.reward), *numbers, equation]
