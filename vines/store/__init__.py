"""The store: keys, immutable results, pools of points, pins; every write is atomic.

Lazy (PEP 562): to read pins and manifests loads neither pyarrow nor filelock.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from vines.store._atomic import write_text
    from vines.store._garbage import Garbage, find_garbage, remove_garbage
    from vines.store._ids import Ids
    from vines.store._keys import canonical, key_of
    from vines.store._parquet import TableFile, read_parquet, write_parquet
    from vines.store._pools import Located, Part, Pool, commit_part
    from vines.store._provenance import revision, versions
    from vines.store._results import Result, describe_file, describe_table, read_result
    from vines.store._sealed import read_sealed, write_sealed
    from vines.store._store import Store

__all__ = [
    "Garbage",
    "Ids",
    "Located",
    "Part",
    "Pool",
    "Result",
    "Store",
    "TableFile",
    "canonical",
    "commit_part",
    "describe_file",
    "describe_table",
    "find_garbage",
    "key_of",
    "read_parquet",
    "read_result",
    "read_sealed",
    "remove_garbage",
    "revision",
    "versions",
    "write_parquet",
    "write_sealed",
    "write_text",
]

_HOMES = {
    "Garbage": "vines.store._garbage",
    "Ids": "vines.store._ids",
    "Located": "vines.store._pools",
    "Part": "vines.store._pools",
    "Pool": "vines.store._pools",
    "Result": "vines.store._results",
    "Store": "vines.store._store",
    "TableFile": "vines.store._parquet",
    "canonical": "vines.store._keys",
    "commit_part": "vines.store._pools",
    "describe_file": "vines.store._results",
    "describe_table": "vines.store._results",
    "find_garbage": "vines.store._garbage",
    "key_of": "vines.store._keys",
    "read_parquet": "vines.store._parquet",
    "read_result": "vines.store._results",
    "read_sealed": "vines.store._sealed",
    "remove_garbage": "vines.store._garbage",
    "revision": "vines.store._provenance",
    "versions": "vines.store._provenance",
    "write_parquet": "vines.store._parquet",
    "write_sealed": "vines.store._sealed",
    "write_text": "vines.store._atomic",
}


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(_HOMES[name]), name)
