"""The forms of everything stored, read from ``schemas/``: the messages of logs and the columns of tables.

Lazy (PEP 562): a name loads its module on first use, so that a command that only needs tables loads no
protobuf and one that only needs messages no pyarrow.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from vines.schema._messages import (
        WireFormat,
        field_notes,
        file_descriptor_set,
        foxglove_schema,
        message_class,
        message_names,
        numpy_dtype,
        schema_bytes,
        wire_format,
    )

__all__ = [
    "WireFormat",
    "field_notes",
    "file_descriptor_set",
    "foxglove_schema",
    "message_class",
    "message_names",
    "numpy_dtype",
    "schema_bytes",
    "wire_format",
]

_HOMES: dict[str, str] = {
    "Column": "vines.schema._tables",
    "Table": "vines.schema._tables",
    "arrow_schema": "vines.schema._tables",
    "cast": "vines.schema._tables",
    "check_values": "vines.schema._validate",
    "disagreements": "vines.schema._validate",
    "metadata_disagreements": "vines.schema._validate",
    "units": "vines.schema._validate",
    "digest": "vines.schema._tables",
    "reference": "vines.schema._reference",
    "table": "vines.schema._tables",
    "toml": "vines.schema._toml",
    "tables": "vines.schema._tables",
    "WireFormat": "vines.schema._messages",
    "field_notes": "vines.schema._messages",
    "file_descriptor_set": "vines.schema._messages",
    "foxglove_schema": "vines.schema._messages",
    "message_class": "vines.schema._messages",
    "message_names": "vines.schema._messages",
    "numpy_dtype": "vines.schema._messages",
    "schema_bytes": "vines.schema._messages",
    "wire_format": "vines.schema._messages",
}
"""Each public name and the module that defines it."""


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(importlib.import_module(_HOMES[name]), name)


def __dir__() -> list[str]:
    return sorted([*globals(), *_HOMES])
