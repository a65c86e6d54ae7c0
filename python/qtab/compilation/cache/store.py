"""Compiled code and its proofs, in this process and in files."""

import contextlib
import hashlib
import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from qtab.compilation.cache import code_files, machine_code
from qtab.compilation.cache.digest import Digest
from qtab.compilation.cache.machine_code import MachineCode
from qtab.compilation.interface.compiled_env import CompiledEnv
from qtab.compilation.not_compilable import NotCompilable, NotNow

VALUES_KEPT = 4096
"""The number of values of the parameters whose proofs a file contains; the oldest are left out."""

Outcome: TypeAlias = NotCompilable | None
"""What a proof has found: a difference, or None."""


class Store:
    """The code of environments by digests, and for each the values of the parameters that it is proven for.

    The code depends on the types of the parameters only, but whether it gives the numbers of Python may depend on their
    values: they may select a branch. Each value is therefore compared once.
    """

    def __init__(self) -> None:
        self._lock = threading.RLock()
        self._found: dict[str, CompiledEnv | NotCompilable] = {}
        self._proofs: dict[str, dict[str, Outcome]] = {}
        self._unknown: dict[str, tuple[Any, ...]] = {}
        """The values that digests identify by their addresses, which no other values may get."""

    def compiled(
        self,
        of: Digest,
        file: str,
        parameters: NDArray[np.uint8],
        make: Callable[[], tuple[MachineCode, dict[str, Any]]],
        load: Callable[[MachineCode, dict[str, Any]], CompiledEnv],
        prove: Callable[[CompiledEnv], None],
    ) -> CompiledEnv:
        """Returns the code for a digest, after its proof for these parameters.

        Args:
            of: The digest of everything that the code depends on. With values that have no digest, nothing is stored
                in files, since other processes do not have these values.
            file: The user's file, beside which the code is stored.
            parameters: The parameters, as bytes.
            make: Compiles the environment; returns the code and what describes it, as values of JSON.
            load: Loads the code.
            prove: Compares the code with Python for the parameters.

        Raises:
            NotCompilable: if the environment cannot be compiled, or a number differs with these parameters.
        """
        digest, file = of.text, "" if of.unknown else file
        with self._lock:
            found = self._found.get(digest) or self._stored(digest, file, load) or self._made(digest, file, make, load)
            self._found[digest], self._unknown[digest] = found, of.unknown
            outcome = found if isinstance(found, NotCompilable) else self._proof(digest, file, parameters, found, prove)
        if outcome is not None:
            raise NotCompilable(outcome.reason, outcome.file, outcome.line, outcome.advice, outcome.others)
        assert isinstance(found, CompiledEnv)  # noqa: S101 - the other outcomes are raised
        return found

    def _stored(self, digest: str, file: str, load: Callable[..., CompiledEnv]) -> CompiledEnv | NotCompilable | None:
        stored = code_files.read(file, digest) if file else None
        if stored is None:
            return None
        code, description = stored
        if code is None:
            return _refusal_of(description["refusal"], file)
        with contextlib.suppress(machine_code.CannotLoad):
            return load(code, description)
        return None

    def _made(
        self,
        digest: str,
        file: str,
        make: Callable[[], tuple[MachineCode, dict[str, Any]]],
        load: Callable[[MachineCode, dict[str, Any]], CompiledEnv],
    ) -> CompiledEnv | NotCompilable:
        """Returns compiled code, or the refusal, and stores it; what holds only now is raised."""
        try:
            code, description = make()
            compiled = load(code, description)
        except machine_code.CannotLoad as error:
            return NotCompilable(str(error))
        except NotNow:
            raise
        except NotCompilable as refusal:
            if file:
                code_files.write(file, digest, None, {"refusal": _to_json(refusal, file)})
            return refusal
        if file:
            code_files.write(file, digest, code, description)
        return compiled

    def _proof(
        self,
        digest: str,
        file: str,
        parameters: NDArray[np.uint8],
        compiled: CompiledEnv,
        prove: Callable[[CompiledEnv], None],
    ) -> Outcome:
        key = hashlib.sha256(parameters.tobytes()).hexdigest()
        if digest not in self._proofs:
            self._proofs[digest] = _stored_proofs(digest, file)
        proofs = self._proofs[digest]
        if key in proofs:
            return proofs[key]
        try:
            prove(compiled)
        except NotNow:
            raise
        except NotCompilable as refusal:
            proofs[key] = refusal
        else:
            proofs[key] = None
        if file:
            # Other processes may have added values since; if two write at once, the values of one are proven again.
            kept = list({**_stored_proofs(digest, file), **proofs}.items())[-VALUES_KEPT:]
            values = {one: None if outcome is None else _to_json(outcome, file) for one, outcome in kept}
            code_files.write(file, _name_of_proofs(digest), None, {"proofs": values})
        return proofs[key]


def _name_of_proofs(digest: str) -> str:
    return f"{digest}-proofs"


def _stored_proofs(digest: str, file: str) -> dict[str, Outcome]:
    stored = code_files.read(file, _name_of_proofs(digest)) if file else None
    if stored is None:
        return {}
    values = stored[1]["proofs"]
    return {one: None if value is None else _refusal_of(value, file) for one, value in values.items()}


def _to_json(refusal: NotCompilable, file: str) -> list[Any]:
    """Returns a refusal without the folders of files, which may be moved."""
    name = None if refusal.file is None or refusal.file == file else Path(refusal.file).name
    others = [_to_json(one, file) for one in refusal.others]
    return [refusal.reason, refusal.file == file, name, refusal.line, refusal.advice, others]


def _refusal_of(stored: list[Any], file: str) -> NotCompilable:
    reason, same_file, name, line, advice, others = stored
    return NotCompilable(reason, file if same_file else name, line, advice, [_refusal_of(one, file) for one in others])
