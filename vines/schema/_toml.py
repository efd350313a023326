"""The file of a table with every column written out, for readers who have no vines."""

from __future__ import annotations

import dataclasses
import json

from vines.model import VI_NES
from vines.schema._tables import table

__all__ = ["toml"]


def toml(name: str) -> str:
    """Return a table's declaration in TOML.

    Examples
    --------
    >>> import tomllib
    >>> [column["name"] for column in tomllib.loads(toml("points"))["columns"]][:4]
    ['point_id', 'mu', 'A', 'Omega']
    """
    spec = table(name)
    head = {"name": spec.name, "version": spec.version, "description": spec.description, "stored": spec.stored}
    head |= {} if spec.system == VI_NES.name else {"system": spec.system}
    lines = _pairs(head)
    for column in spec.columns:
        given = {key: value for key, value in dataclasses.asdict(column).items() if value not in (None, ())}
        lines += ["", "[[columns]]", *_pairs(given)]
    return "\n".join(lines) + "\n"


def _pairs(values: dict[str, object]) -> list[str]:
    # JSON's texts, numbers, truth values and lists of texts are TOML's.
    return [f"{key} = {json.dumps(value, ensure_ascii=False)}" for key, value in values.items()]
