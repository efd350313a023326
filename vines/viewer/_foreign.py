"""Logs of other people, as Rerun's own reader of MCAP shows them."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import rerun as rr

from vines.errors import ViewerError
from vines.logs import Log
from vines.viewer._remarks import is_foreign, remarks

__all__ = ["write_foreign"]


def write_foreign(logs: Sequence[Log], out: Path) -> None:
    """Write one log that vines did not write as a recording, without a layout.

    Raises
    ------
    ViewerError
        If there are several, or Rerun draws none of its channels.
    """
    if len(logs) > 1:
        other = next(log for log in logs if is_foreign(log))
        raise ViewerError(f"{other.path} is not a log of vines and has no layout beside others; view it alone")
    (log,) = logs
    if not any(kind in ("protobuf", "cdr") for kind in log.encodings.values()):
        raise ViewerError(f"{log.path} holds nothing that can be drawn: {'; '.join(remarks(log)[1:]) or 'no channel'}")
    rec = rr.RecordingStream("vines", recording_id=log.sha256[:32], send_properties=False)
    rec.save(out)
    rec.send_recording_name(log.name)
    rec.log_file_from_path(log.path)
    rec.flush()
    rec.disconnect()
