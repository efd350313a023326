"""Are the stored results intact and physically consistent? What ``vines verify`` asks."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from vines.errors import StoreError, UnknownNameError
from vines.stages.api._home import Home, current
from vines.stages.api._stored import stored_pipelines
from vines.stages.audit._exits import check_exit_counts
from vines.stages.audit._files import check_files, check_provenance, check_schema
from vines.stages.audit._kept import check_pool, check_rows
from vines.stages.audit._ledger import Ledger, Line
from vines.stages.audit._links import check_links
from vines.stages.audit._physics import check_physics

if TYPE_CHECKING:
    import pyarrow as pa

    from vines.store import Result, Store

__all__ = ["Verification", "verify"]


@dataclass(frozen=True, slots=True)
class Verification:
    """What a verification found.

    Attributes
    ----------
    results, rows : int
        How many results and rows were verified.
    lines : tuple of Line
        One for each check.
    """

    results: int
    rows: int
    lines: tuple[Line, ...]

    @property
    def good(self) -> bool:
        """Whether every check holds."""
        return all(line.good for line in self.lines)


def verify(
    *names: str,
    everything: bool = False,
    recompute: int = 0,
    seed: int = 0,
    report: Callable[[str], object] | None = None,
    study: Home | None = None,
) -> Verification:
    """Check stored results: files, schemas, provenance, and the physics of every row.

    Nothing is computed again unless asked: the checks are balances, closed forms and quadratures over the stored
    values (docs/verify.md). Files are only read.

    Parameters
    ----------
    names : str
        Pipelines or collections of them; all that were run if left out.
    everything : bool
        Also the results that nothing refers to any more.
    recompute : int
        So many rows, drawn at random, are computed again from their provenance and stored start state alone and
        compared as docs/verify.md says.
    seed : int
        Seed of the draw.
    report : callable, optional
        Gets a line for everything that begins.
    study : Home, optional
        Whose; the one that the current folder belongs to if left out.

    Returns
    -------
    Verification

    Raises
    ------
    UnknownNameError
        If there is no such pipeline, or nothing is stored.

    Examples
    --------
    >>> import tempfile, vines
    >>> verify(study=vines.study(tempfile.mkdtemp()))
    Traceback (most recent call last):
        ...
    vines.errors.UnknownNameError: nothing is stored yet; run 'vines run quickstart' first
    """
    study = study or current()
    store = study.store
    ledger = Ledger()
    say = report or (lambda line: None)
    results = _results(study, names, everything, ledger)
    rows = 0
    intact: dict[str, Result] = {}
    for where, result in results.items():
        say(f"{where}: {sum(about['rows'] for about in result.manifest['tables'].values())} rows")
        if _check_result(ledger, where, result, store):
            intact[where] = result
        rows += sum(about["rows"] for about in result.manifest["tables"].values())
    if recompute:
        from vines.stages.audit._recompute import recompute_rows

        recompute_rows(ledger, intact, recompute, np.random.default_rng(seed), say)
    return Verification(len(results), rows, tuple(ledger.lines))


def _results(study: Home, names: tuple[str, ...], everything: bool, ledger: Ledger) -> dict[str, Result]:
    """Return the results to verify by ``<pipeline>.<stage>``; one that several stages share comes once."""
    store = study.store
    pinned, damaged = store.readable_pins()
    known = {*pinned, *damaged}
    chosen = {name: pinned.get(name, {}) for name in stored_pipelines(names, known, study.root)}
    keys: dict[str, str] = {}
    says = "a result for each pin"
    for pipeline, pins in chosen.items():
        if pipeline in damaged:
            ledger.note("files", "pins", says, "stages", damaged[pipeline])
        for stage, pin in sorted(pins.items()):
            where = f"{pipeline}.{stage}"
            there = (store.results / pin["result"]).is_dir()
            missing = "" if there else f"{where}: result {pin['result'][:12]} is not stored any more"
            ledger.note("files", "pins", says, "stages", missing)
            if there:
                keys.setdefault(pin["result"], where)
    if everything and store.results.is_dir():
        for path in sorted(store.results.iterdir()):
            keys.setdefault(path.name, path.name[:12])
    if not keys and not ledger.lines:
        raise UnknownNameError("nothing is stored yet; run 'vines run quickstart' first")
    found = {}
    for key, where in keys.items():
        for strict in (True, False):  # what is damaged and can be read is looked at all the same
            try:
                found[where] = store.result(key, strict=strict)
                break
            except StoreError as error:
                if strict:
                    ledger.note("files", "manifests", "as they were written", "results", f"{where}: {error}")
    return found


def _check_result(ledger: Ledger, where: str, result: Result, store: Store) -> bool:
    """Check one result and say whether its tables can be computed again."""
    import pyarrow as pa

    check_files(ledger, where, result)
    check_pool(ledger, where, result, store)
    readable = {name: check_schema(ledger, where, result, name) for name in result.tables}
    primary = None
    try:
        if result.tables and readable[result.tables[0]]:
            primary = _primary(result)
            check_rows(ledger, where, result, primary)
        check_provenance(ledger, where, result, store, primary)
        for name in result.tables:
            if readable[name] and (name != "impacts" or readable.get("points", True)):
                check_physics(ledger, where, result, name)
        if all(readable.values()):
            check_links(ledger, where, result)
            check_exit_counts(ledger, where, result)
    except (OSError, pa.ArrowException) as error:
        text = f"{where}: a table cannot be read: {str(error).splitlines()[0]}"
        ledger.note("files", "schemas", "", "tables", text)
        return False
    return all(readable.values())


def _primary(result: Result) -> pa.Table:
    """Return of the primary table what keys and ids are made of."""
    import pyarrow.parquet as pq

    path = result.folder / f"{result.tables[0]}.parquet"
    wanted = {"point_id", "status", *(axis[0] for axis in result.manifest["ingredients"]["vary"])}
    return pq.read_table(path, columns=[name for name in pq.read_schema(path).names if name in wanted])
