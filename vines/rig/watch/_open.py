"""From the text that names a source to the source."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path
from urllib.parse import parse_qsl, urlsplit

from vines.errors import RigError
from vines.rig.ingest import Cells
from vines.rig.synth import RigSettings
from vines.rig.watch._folder import STEADY, FolderSource
from vines.rig.watch._ni import NiSource
from vines.rig.watch._socket import SocketSource
from vines.rig.watch._stream import Source
from vines.rig.watch._synth import SynthSource

__all__ = ["open_source"]

_FORMS = "a folder, tcp://HOST:PORT, listen://PORT, ni://Dev1/ai0:3?rate=51200 or synth:"


def open_source(
    text: str,
    *,
    rows: Sequence[Cells] = (),
    settings: RigSettings | None = None,
    seed: int = 0,
    speed: float = 1.0,
    steady: float = STEADY,
    present: bool = False,
) -> Source:
    """Return the source that a text names.

    Parameters
    ----------
    text : str
        ``FOLDER``, ``tcp://HOST:PORT``, ``listen://PORT``, ``ni://Dev1/ai0:3?rate=51200`` or ``synth:``.
    rows : sequence of Cells
        ``channels.tsv`` for a device or files.
    settings, seed, speed
        Of the synthetic rig.
    steady, present
        Of a folder, see :class:`FolderSource`.

    Raises
    ------
    RigError, FileMissingError, PackageMissingError, ParameterError
        If there is no such source; one line.
    """
    scheme, mark, rest = text.partition(":")
    if mark and scheme == "synth":
        if rest.strip("/"):
            raise RigError(f"{text}: settings of the synthetic rig are given by --set, as in synth: --set E=2.5e-4")
        return SynthSource(settings or RigSettings(settle=0.0), seed, speed=speed)
    if mark and rest.startswith("//"):
        if scheme in ("tcp", "listen"):
            return _socket(text, scheme, rest[2:])
        if scheme == "ni":
            parts = urlsplit(text)
            return NiSource(f"{parts.netloc}{parts.path}", dict(parse_qsl(parts.query)), rows)
        raise RigError(f"{text}: no source {scheme!r}; allowed are {_FORMS}")
    return FolderSource(Path(text), rows, steady=steady, present=present)


def _socket(text: str, scheme: str, where: str) -> SocketSource:
    match = re.fullmatch(r"(?:(?P<host>[\w.-]+|\[[0-9a-fA-F:]+\]):)?(?P<port>\d+)/?", where)
    if match is None or not 0 < int(match["port"]) < 65536 or (scheme == "tcp" and not match["host"]):
        form = "listen://5555" if scheme == "listen" else "tcp://127.0.0.1:5555"
        raise RigError(f"{text}: write it as {form}, with a port from 1 to 65535")
    if scheme == "listen" and match["host"] not in (None, "127.0.0.1", "localhost"):
        raise RigError(f"{text}: it listens on this machine only; write listen://{match['port']}")
    return SocketSource((match["host"] or "").strip("[]"), int(match["port"]), listen=scheme == "listen")
