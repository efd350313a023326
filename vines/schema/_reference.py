"""The reference page of all tables, made from ``schemas/``."""

from __future__ import annotations

from vines.schema._tables import tables

__all__ = ["reference"]

_HEAD = """\
# Reference: the tables

Every table of results: what a row is, and each column with its unit, meaning and allowed values.
[tables.md](tables.md) explains the words and how tables are stored. Units: `1` dimensionless, `rad`, `T` forcing
periods, `1/T`, `B` bytes; SI units where a table holds measurements. Empty values are allowed everywhere but in
`point_id`.

Made from `schemas/*.toml` by `vines schema --markdown > docs/reference_tables.md`; don't edit it by hand.
"""


def reference() -> str:
    """Return the page, in Markdown.

    Examples
    --------
    >>> reference().splitlines()[0]
    '# Reference: the tables'
    """
    lines = [_HEAD]
    for name, spec in tables().items():
        lines += [
            f"## {name}",
            "",
            f"{spec.description} Version {spec.version}{'' if spec.stored else ', not stored'}.",
            "",
            "| column | type | unit | what it is | allowed | source |",
            "|---|---|---|---|---|---|",
        ]
        for c in spec.columns:
            cells = [f"`{c.name}`", c.dtype, c.unit, c.description, c.allowed, c.source]
            lines.append("| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |")
        lines.append("")
    return "\n".join(lines)
