"""Kinds of a rig: a synthetic campaign, what was measured, what follows from it, and the model beside it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import msgspec

from vines.errors import ParameterError
from vines.pipeline import Kind, register
from vines.stages.api._warm_up import COMPARE

__all__ = ["CompareOptions", "IngestOptions", "ReconstructOptions", "SynthOptions", "register_rig"]


class SynthOptions(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A synthetic campaign: a sweep of the base amplitude up and down with ring-downs between.

    `amplitudes` are A = E/b in rising order, `settings` those of the synthetic rig (docs/rig.md), `draw` draws its
    imperfections over their ranges, `warming` is the change of temperature over the campaign [K].
    """

    amplitudes: tuple[float, ...]
    seed: int = 0
    draw: bool = False
    warming: float = 0.0
    settings: dict[str, Any] = {}


class IngestOptions(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Run folders at or below `folder` (from the root of the project), or those that the needed stage made.

    `log_rate` is the number of samples a second of a channel in the logs at most; 0 keeps all.
    """

    folder: str = ""
    log_rate: float = 2048.0


class ReconstructOptions(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Every run with the ball of the needed stages of kind `ingest`; `seed` is that of the draws for uncertainties."""

    seed: int = 0


class CompareOptions(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Every run of the needed stages of kind `reconstruct` beside the branches that coexist at its parameters.

    Needed stages with orbits, such as those of kind `branch`, are the catalogue: they say which words to look for.
    `seed` is that of the ensembles. `record` forcing periods of each run go into a log, beside one of the model.
    """

    seed: int = 0
    record: int = 12


def _check_synth(params: dict[str, float], options: Any) -> None:
    del params
    if (
        not options.amplitudes
        or list(options.amplitudes) != sorted(set(options.amplitudes))
        or options.amplitudes[0] <= 0
    ):
        raise ParameterError(f"amplitudes are {list(options.amplitudes)}, allowed are positive numbers in rising order")
    _check_seed(options)


def _check_seeded(params: dict[str, float], options: Any) -> None:
    del params
    _check_seed(options)


def _check_compare(params: dict[str, float], options: Any) -> None:
    del params
    _check_seed(options)
    if options.record < 0:
        raise ParameterError(f"record is {options.record}, allowed is record >= 0")


def _check_seed(options: Any) -> None:
    if options.seed < 0:
        raise ParameterError(f"seed is {options.seed}, allowed is seed >= 0")


def _check_ingest(params: dict[str, float], options: Any) -> None:
    del params
    if options.log_rate < 0:
        raise ParameterError(f"log_rate is {options.log_rate:g}, allowed is log_rate >= 0")


def _run_files(options: Any, root: Path) -> tuple[Path, ...]:
    """Return every file of the run folders, because the result depends on their contents."""
    if not options.folder:
        return ()
    from vines.rig import find_runs, read_folder

    files: list[Path] = []
    for path in find_runs(root / options.folder):
        folder = read_folder(path)
        files += [path / "run.json", path / "channels.tsv", *folder.raw_files, *folder.sidecars]
    return tuple(files)


def register_rig() -> None:
    """Make the kinds of a rig known to declarations."""
    register(
        Kind(
            name="synth",
            summary="run folders of a synthetic rig, a sweep up and down with ring-downs; their truth is sealed",
            shape="whole",
            options=SynthOptions,
            body="vines.stages.rig._synth:compute",
            tables=("rig_made",),
            check=_check_synth,
        )
    )
    register(
        Kind(
            name="ingest",
            summary="run folders of a rig in SI units: raw files kept, MCAP logs, and what was measured",
            shape="whole",
            options=IngestOptions,
            body="vines.stages.rig._ingest:compute",
            tables=("rig_runs", "rig_channels"),
            needs=True,
            logs=True,
            check=_check_ingest,
            files=_run_files,
        )
    )
    register(
        Kind(
            name="reconstruct",
            summary="runs of a rig brought to the quantities of the model, with uncertainties, gates and their impacts",
            shape="whole",
            options=ReconstructOptions,
            body="vines.stages.rig._reconstruct:compute",
            tables=("reconstructions", "rig_impacts"),
            needs=True,
            check=_check_seeded,
        )
    )
    register(
        Kind(
            name="compare",
            summary="runs of a rig beside the branches that coexist at their parameters, with verdicts",
            shape="whole",
            options=CompareOptions,
            body="vines.stages.rig._compare:compute",
            tables=("comparisons", "rig_cycles"),
            needs=True,
            logs=True,
            check=_check_compare,
            kernels=COMPARE,
        )
    )
