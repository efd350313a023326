"""Write the MCAP log of a run, whole or not at all."""

from __future__ import annotations

import json
import os
import secrets
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import BinaryIO

import numpy as np

from vines.errors import FileMissingError, SchemaError
from vines.logs._balls import ball_rows, has_balls
from vines.logs._bare import BESIDE, bare_rows
from vines.logs._bare_balls import profile_of_balls
from vines.logs._channels import CHANNELS, NES, ORBIT, PARAMETERS, PROVENANCE, RUN, Rows, as_rows
from vines.logs._file import LogFile
from vines.logs._pack import cut

__all__ = ["begin", "replacing", "write_rows", "write_run"]


def write_run(
    path: str | os.PathLike[str],
    *,
    states: np.ndarray,
    impacts: np.ndarray,
    sticks: np.ndarray,
    provenance: Mapping[str, object],
    parameters: Mapping[str, float],
    name: str,
    declaration: str | None = None,
    orbit: np.ndarray | None = None,
    word: str | None = None,
    attractor: str | None = None,
    system: str | None = None,
    bare: bool = True,
) -> Path:
    """Write a run as an MCAP log, whole or not at all; the same input gives the same bytes.

    Parameters
    ----------
    path : path-like
        Where; an existing file is replaced.
    states, impacts, sticks : numpy.ndarray, shape (n,), structured
        Rows with the fields of ``vines.v1.State``, ``Impact`` and ``Stick``, sorted by time (sticks by
        ``t_start``); dimensionless, further fields are left out. Of several balls states have the fields of
        ``vines.v1.Oscillator`` and those of ``vines.v1.Ball`` with the number of each ball (``x2_1``), impacts and
        sticks those of ``vines.v1.BallImpact`` and ``BallStick``. With a mass on a spring beside the ball states have
        those of ``vines.v1.Nes`` too.
    provenance : mapping
        Where the numbers come from; values that are not strings are stored as JSON. No wall clock, no host.
    parameters : mapping of str to float
        The parameters of the model.
    name : str
        What the run is called in lists and viewers.
    declaration : str, optional
        The TOML text that declared the run, kept as the attachment ``declaration.toml``.
    orbit : numpy.ndarray, shape (1,), structured, optional
        The fields of ``vines.v1.Orbit`` if the run is one period of a periodic orbit.
    word : str, optional
        Its word.
    attractor : str, optional
        What the run settles to, such as ``"1:1"`` or ``"chaotic"``.
    system : str, optional
        The system of the run, kept in the metadata ``vines.run``; the VI-NES if left out.
    bare : bool
        Whether the log also carries the channels with which it explains itself in a viewer without vines.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    SchemaError
        If the arrays do not fit the schema, or provenance cannot be written as text.
    FileMissingError
        If the folder does not exist.
    """
    several, beside = has_balls(states), "x3" in (states.dtype.names or ())
    if several:
        rows = ball_rows(states, impacts, sticks)
    else:
        every = zip((states, impacts, sticks), CHANNELS, strict=True)
        rows = [as_rows(array, channel) for array, channel in every]
    if beside:
        rows.append(as_rows(states, NES))
    about = {"name": name, "kind": "run"}
    if orbit is not None:
        rows.append(as_rows(orbit, ORBIT))
        about |= {"kind": "orbit", "word": word or ""}
    if attractor is not None:
        about["attractor"] = attractor
    if system is not None:
        about["system"] = system
    if bare:
        # Those of one ball as they are packed, those of several bodies as given: packed they are a table each.
        shown = [states, impacts, sticks] if several or beside else [each.values for each in rows[:3]]
        profile = profile_of_balls(states, parameters) if several else BESIDE if beside else None
        rows += bare_rows(shown[0], shown[1], shown[2], name, parameters, profile)
    return write_rows(path, rows, about, provenance, parameters, declaration)


def write_rows(
    path: str | os.PathLike[str],
    rows: list[Rows],
    about: Mapping[str, str],
    provenance: Mapping[str, object],
    parameters: Mapping[str, float],
    declaration: str | None,
) -> Path:
    """Write the rows of channels as a log, whole or not at all."""
    with replacing(path) as stream:
        log = LogFile(stream)
        begin(log, about, provenance, parameters, declaration)
        for each in rows:
            log.channel(each.channel)
        log.digests()
        log.chunks(cut(rows))
        log.status("complete", {each.channel.topic: str(len(each)) for each in rows})
        log.finish()
    return Path(path)


def begin(
    log: LogFile,
    about: Mapping[str, str],
    provenance: Mapping[str, object],
    parameters: Mapping[str, float],
    declaration: str | None,
) -> None:
    """Write what stands before the channels of a log."""
    texts = _texts(provenance)
    values = {key: repr(float(parameters[key])) for key in sorted(parameters)}
    log.metadata(PROVENANCE, texts)
    log.metadata(RUN, dict(about))
    log.metadata(PARAMETERS, values)
    if declaration is not None:
        log.attachment("declaration.toml", "application/toml", declaration.encode())


@contextmanager
def replacing(path: str | os.PathLike[str]) -> Iterator[BinaryIO]:
    """Give a file to write beside a path, which takes its place when all went well.

    Raises
    ------
    FileMissingError
        If the folder does not exist.
    """
    target = Path(path)
    if not target.parent.is_dir():
        raise FileMissingError(f"the folder {target.parent} of the log {target.name} does not exist; create it first")
    partial = target.with_name(f".{target.name}.{os.getpid()}.{secrets.token_hex(4)}.part")
    try:
        with partial.open("xb") as stream:
            yield stream
            stream.flush()
            os.fsync(stream.fileno())
        partial.replace(target)
    finally:
        partial.unlink(missing_ok=True)


def _texts(provenance: Mapping[str, object]) -> dict[str, str]:
    """Return provenance as sorted text: strings as they are, anything else as JSON with sorted keys."""
    texts: dict[str, str] = {}
    for key in sorted(provenance):
        value = provenance[key]
        try:
            texts[key] = value if isinstance(value, str) else json.dumps(value, sort_keys=True, ensure_ascii=False)
        except (TypeError, ValueError) as unfit:
            raise SchemaError(
                f"provenance {key!r} cannot be stored ({unfit}); text, numbers, lists and dicts are allowed"
            ) from None
    return texts
