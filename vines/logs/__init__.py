"""Logs of runs as MCAP files: protobuf messages with their schema, provenance first, completeness last."""

from vines.logs._live import LiveWriter
from vines.logs._raw import Raw
from vines.logs._read import Log, bytes_of_file, read
from vines.logs._recover import Recovery, read_damaged, recover
from vines.logs._rig import Sensor, write_rig
from vines.logs._tail import Tail
from vines.logs._thin import Thinner, extremes
from vines.logs._unpack import CHUNK_LIMIT
from vines.logs._write import write_run

__all__ = [
    "CHUNK_LIMIT",
    "LiveWriter",
    "Log",
    "Raw",
    "Recovery",
    "Sensor",
    "Tail",
    "Thinner",
    "bytes_of_file",
    "extremes",
    "read",
    "read_damaged",
    "recover",
    "write_rig",
    "write_run",
]
