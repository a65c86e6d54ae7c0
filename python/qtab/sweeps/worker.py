"""What a worker does with a piece of a sweep: it trains and returns values; whoever sent the piece stores them."""

import pickle
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from qtab import _core
from qtab.results.summary import block_means, summarize
from qtab.training.process_pool import train_to_the_end
from qtab.training.resolve import Resolved, resolve
from qtab.training.train_many import allocate, resolve_one, train_in_threads


@dataclass(frozen=True)
class Row:
    """A finished run, or one that failed."""

    seed: int
    summary: dict[str, float | int] | None
    curve: bytes
    """The mean returns of whole blocks of episodes, float64."""
    error: str | None = None


def train_piece(task: bytes) -> list[Row]:
    """Trains ``(env, [(overrides, seeds), ...], block)``, pickled by cloudpickle, on one thread."""
    env, shares, block = pickle.loads(task)  # noqa: S301 - from the process that submitted it
    rows: list[Row] = []
    for overrides, seeds in shares:
        try:
            resolved = resolve_one(env, {**overrides, "seed": seeds[0]})
        except Exception as error:
            rows += [_failed(seed, error) for seed in seeds]
        else:
            rows += train_share(env, overrides, resolved, seeds, block, threads=1)
    return rows


def train_share(
    env: Any, overrides: dict[str, Any], resolved: Resolved, seeds: Sequence[int], block: int, threads: int
) -> list[Row]:
    """Trains one setting's seeds; a run that fails leaves its error and the others go on."""
    if resolved.model is None:
        return [_in_python(env, overrides, seed, block) for seed in seeds]
    results = allocate(resolved, len(seeds), threads, tables=False, limit=2**63)
    failed = dict(train_in_threads(resolved, tuple(seeds), results, threads, keep_going=True))
    rows = _rows(seeds, block, results["returns"], results["lengths"], results["terminated"])
    return [_failed(row.seed, failed[index]) if index in failed else row for index, row in enumerate(rows)]


def _in_python(env: Any, overrides: dict[str, Any], seed: int, block: int) -> Row:
    made = env() if callable(env) else env
    try:
        resolved = resolve(made, {**overrides, "seed": seed})
        try:
            trainer = _core.Trainer(resolved.spec(), resolved.seed)
            train_to_the_end(trainer, resolved.config.episodes)
            returns, lengths, terminated = (column[np.newaxis] for column in trainer.episodes())
            return _rows([seed], block, returns, lengths, terminated)[0]
        finally:
            if resolved.env is not None:
                resolved.env.close()
    except Exception as error:
        return _failed(seed, error)


def _rows(seeds: Sequence[int], block: int, returns: Any, lengths: Any, terminated: Any) -> list[Row]:
    columns = {name: column.tolist() for name, column in summarize(returns, lengths, terminated).items()}
    curves = block_means(returns, block)
    return [
        Row(seed, {name: column[index] for name, column in columns.items()}, curves[index].tobytes())
        for index, seed in enumerate(seeds)
    ]


def _failed(seed: int, error: Exception) -> Row:
    return Row(seed, None, b"", f"{type(error).__name__}: {error}")
