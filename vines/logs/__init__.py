"""Logs of runs as MCAP files: protobuf messages with their schema, provenance first, completeness last."""

from vines.logs._read import Log, read
from vines.logs._write import write_run

__all__ = ["Log", "read", "write_run"]
