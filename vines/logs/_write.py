"""Write the MCAP log of a run, whole or not at all."""

from __future__ import annotations

import json
import os
import secrets
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from vines.errors import FileMissingError, SchemaError
from vines.logs._channels import CHANNELS, PARAMETERS, PROVENANCE, RUN, STATUS, as_messages, log_times
from vines.logs._file import LogFile
from vines.logs._pack import cut

__all__ = ["write_run"]


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
) -> Path:
    """Write a run as an MCAP log, whole or not at all; the same input gives the same bytes.

    Parameters
    ----------
    path : path-like
        Where; an existing file is replaced.
    states, impacts, sticks : numpy.ndarray, shape (n,), structured
        Rows with the fields of ``vines.v1.State``, ``Impact`` and ``Stick``, sorted by time (sticks by
        ``t_start``); dimensionless, further fields are left out.
    provenance : mapping
        Where the numbers come from; values that are not strings are stored as JSON. No wall clock, no host.
    parameters : mapping of str to float
        The parameters of the model.
    name : str
        What the run is called in lists and viewers.
    declaration : str, optional
        The TOML text that declared the run, kept as the attachment ``declaration.toml``.

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
    target = Path(path)
    if not target.parent.is_dir():
        raise FileMissingError(f"the folder {target.parent} of the log {target.name} does not exist; create it first")
    given = {"states": states, "impacts": impacts, "sticks": sticks}
    messages = {channel: as_messages(given[channel.key], channel) for channel in CHANNELS}
    about = _texts(provenance)
    values = {key: repr(float(parameters[key])) for key in sorted(parameters)}

    partial = target.with_name(f".{target.name}.{os.getpid()}.{secrets.token_hex(4)}.part")
    try:
        with partial.open("xb") as stream:
            log = LogFile(stream)
            log.metadata(PROVENANCE, about)
            log.metadata(RUN, {"name": name})
            log.metadata(PARAMETERS, values)
            if declaration is not None:
                log.attachment("declaration.toml", "application/toml", declaration.encode())
            for channel in CHANNELS:
                log.channel(channel)
            for parts in cut({channel: log_times(rows[channel.time]) for channel, rows in messages.items()}):
                log.chunk({channel: messages[channel][part] for channel, part in parts.items()}, parts)
            counts = {channel.topic: str(len(rows)) for channel, rows in messages.items()}
            log.metadata(STATUS, {"status": "complete", **counts})
            log.finish()
            stream.flush()
            os.fsync(stream.fileno())
        partial.replace(target)
    finally:
        partial.unlink(missing_ok=True)
    return target


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
