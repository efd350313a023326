"""Reconstructing and comparing a run folder by hand: ring-downs are found beside it, what follows goes to derived/."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import msgspec

from vines import schema
from vines.errors import RigError, VinesError
from vines.pipeline import CodeDigests
from vines.rig import RingDown, RunInfo, compare, find_runs, load_reconstruction, match_ring_downs, read_folder
from vines.rig.formats import readers
from vines.rig.ingest import CAMPAIGN
from vines.rig.records import comparison_rows, impact_columns, reconstruction_row
from vines.stages.api._asking import query
from vines.stages.api._home import Home, current
from vines.stages.rig._refused import reason_of, told_of
from vines.stages.rig._runs import free_decay, make, wanted
from vines.store import write_parquet, write_text

if TYPE_CHECKING:
    from vines.rig import Reconstruction
    from vines.rig.verdict import Comparison

__all__ = ["Compared", "Derived", "compare_run", "each_of", "is_campaign", "reconstruct_run", "runs_with_ball"]

Made = TypeVar("Made")


@dataclass(frozen=True, slots=True)
class Derived:
    """What a run folder was brought to.

    Attributes
    ----------
    found : Reconstruction
    ring_downs : tuple of str
        The runs that gave omega0 and lam.
    row : dict
        As in the table ``reconstructions``.
    files : tuple of Path
        What was written to ``derived/``.
    """

    found: Reconstruction
    ring_downs: tuple[str, ...]
    row: dict[str, Any]
    files: tuple[Path, ...]


def reconstruct_run(folder: Path, ring_downs: Sequence[Path] = (), *, study: Home | None = None) -> Derived:
    """Reconstruct one run, and write ``reconstruction.json`` and ``rig_impacts.parquet`` to its ``derived/``.

    Parameters
    ----------
    folder : Path
        A run folder, ball in.
    ring_downs : sequence of Path
        Run folders of its ring-downs; if left out, those that its ``run.json`` names, else its neighbours in time,
        among the run folders beside it.
    study : Home, optional
        Whose; the one that the current folder belongs to if left out.

    Returns
    -------
    Derived

    Raises
    ------
    FileMissingError
        If it is no run folder, or a file is missing.
    RigError
        If the run is refused, one of its ring-downs is not there, or it shows too few impacts; one line says why.
    """
    study = study or current()
    if is_campaign(folder):
        raise RigError(f"{folder} holds run folders; name one of them, or go over them with each_of")
    _check_place(folder, study)
    info = read_folder(folder).info
    if info.protocol == "ringdown":
        raise RigError(f"run {info.run_id!r} is a ring-down: it gives omega0 and lam of the runs that name it")
    chosen, decays = _ring_downs(folder, info, ring_downs)
    code = CodeDigests(study.cache / "code.json").digest("vines.stages.rig._reconstruct:compute", *readers())
    work = wanted(folder, decays, 0, code, study.cache)
    if refused := make(work):
        raise RigError(refused)
    found = load_reconstruction(work.kept)
    row = reconstruction_row(found, chosen)
    derived = folder / "derived"
    derived.mkdir(exist_ok=True)
    told, impacts = derived / "reconstruction.json", derived / "rig_impacts.parquet"
    write_text(told, _json(row))
    origin = {"stage": "vines rig reconstruct", "code": code, "raw_sha256": found.sha256, "ring_downs": list(chosen)}
    write_parquet(impacts, "rig_impacts", schema.cast("rig_impacts", impact_columns([found])), provenance=origin)
    return Derived(found, chosen, row, (told, impacts))


def is_campaign(folder: Path) -> bool:
    """Say whether a folder holds run folders and is none itself.

    Raises
    ------
    FileMissingError
        If it is neither.
    """
    if (
        any((folder / name).exists() for name in ("run.json", "channels.tsv", "raw"))
        and not (folder / CAMPAIGN).exists()
    ):
        return False
    find_runs(folder)  # says what is missing where there are no runs at all
    return True


def runs_with_ball(folder: Path) -> tuple[Path, ...]:
    """Return the run folders in a folder that are no ring-downs, those too that cannot be read.

    Raises
    ------
    FileMissingError
        If there is no run folder.
    RigError
        If all are ring-downs.
    """
    found = tuple(path for path in find_runs(folder) if not _is_ring_down(path))
    if not found:
        raise RigError(f"{folder} holds ring-downs only: none of its runs has the ball in it")
    return found


def _is_ring_down(path: Path) -> bool:
    try:
        return read_folder(path).info.protocol == "ringdown"
    except VinesError:
        return told_of(path).get("protocol") == "ringdown"


def each_of(
    folder: Path, work: Callable[[Path], Made], study: Home | None = None
) -> Iterator[tuple[str, Made | None, str]]:
    """Do something with each run of a folder; yield its name, what was made, and the reason if that could not be.

    Parameters
    ----------
    folder : Path
        With run folders in it.
    work : callable
        ``work(run folder)``, such as `reconstruct_run`.
    study : Home, optional
        Whose; see `reconstruct_run`.

    Raises
    ------
    FileMissingError, RigError
        As for `runs_with_ball`, and if it lies in the store.
    """
    _check_place(folder, study or current())
    for path in runs_with_ball(folder):
        try:
            yield path.name, work(path), ""
        except Exception as error:
            # Whatever is wrong with one run, the others go on.
            yield path.name, None, reason_of(error)


def _check_place(folder: Path, study: Home) -> None:
    if folder.resolve().is_relative_to(study.store.results.resolve()):
        raise RigError(f"{folder} is a stored result, which is never changed; name the run folder that was ingested")


@dataclass(frozen=True, slots=True)
class Compared:
    """A run folder beside the model.

    Attributes
    ----------
    derived : Derived
        The run.
    found : Comparison
    rows : list of dict
        As in the table ``comparisons``.
    file : Path
        What was written to ``derived/``.
    """

    derived: Derived
    found: Comparison
    rows: list[dict[str, Any]]
    file: Path


def compare_run(folder: Path, ring_downs: Sequence[Path] = (), *, study: Home | None = None) -> Compared:
    """Reconstruct one run, compare it with the branches that coexist, and write ``derived/comparison.json``.

    The orbits that the catalogue holds near the run's parameters say which words are looked for beside the usual ones.

    Parameters
    ----------
    folder, ring_downs, study
        As for `reconstruct_run`.

    Raises
    ------
    FileMissingError, RigError
        As for `reconstruct_run`.
    """
    study = study or current()
    derived = reconstruct_run(folder, ring_downs, study=study)
    found = compare(derived.found, _near(derived.row, study))
    file, text = folder / "derived" / "comparison.json", _json(comparison_rows(found))
    write_text(file, text)
    return Compared(derived, found, msgspec.json.decode(text), file)


def _near(row: dict[str, Any], study: Home) -> list[dict[str, Any]]:
    """Return of each branch of the catalogue its orbit nearest to a run, if that is within a fifth of its A and mu."""
    if not all(row[name] for name in ("A", "mu")):
        return []
    apart = [f"abs({name} / {row[name]!r} - 1)" for name in ("A", "mu")]
    return query(
        f"select word, branch_id, mu, A, Omega, r, lam, t from orbits where greatest({', '.join(apart)}) <= 0.2 "
        f"qualify row_number() over (partition by pipeline, stage, branch_id order by {' + '.join(apart)}, A, mu) = 1",
        study=study,
    ).to_pylist()


def _json(content: Any) -> str:
    """Return JSON in which what is not finite is null."""
    return msgspec.json.format(msgspec.json.encode(content, enc_hook=float), indent=1).decode() + "\n"


def _ring_downs(folder: Path, info: RunInfo, given: Sequence[Path]) -> tuple[tuple[str, ...], list[RingDown]]:
    """Return the ring-downs that belong to a run, among those given or the run folders beside it.

    One beside it that cannot be read, or gives no omega0, is as if it had not been made, but for a run that names it.
    """
    known = _given(given) if given else _beside(folder)
    tried = {name: free_decay(path) for name, (path, _) in known.items()} if given else {}
    while True:
        names = tuple(known) if given else match_ring_downs(info, [one for _, one in known.values()])
        tried |= {name: free_decay(known[name][0]) for name in names if name not in tried}
        found = [one for name in names if not isinstance(one := tried[name], str)]
        if len(found) == len(names):
            return names, found
        bad = next(name for name in names if isinstance(tried[name], str))
        others = [name for name in known if name != bad]
        if given or bad in info.ringdown or not others:
            raise RigError(f"run {info.run_id!r}: its ring-down {bad!r} gives no omega0: {tried[bad]}")
        del known[bad]


def _given(folders: Sequence[Path]) -> dict[str, tuple[Path, RunInfo]]:
    found = {}
    for path in folders:
        info = read_folder(path).info
        if info.protocol != "ringdown":
            raise RigError(f"{path} is a run of protocol {info.protocol}, allowed for --ringdown is ringdown")
        found[info.run_id] = (path, info)
    return found


def _beside(folder: Path) -> dict[str, tuple[Path, RunInfo]]:
    """Return the ring-downs among the run folders beside a run; those that can't be read are not."""
    known: dict[str, tuple[Path, RunInfo]] = {}
    for path in find_runs(folder.resolve().parent):
        try:
            other = read_folder(path).info
        except VinesError:
            continue
        if other.protocol == "ringdown":
            known[other.run_id] = (path, other)
    return known
