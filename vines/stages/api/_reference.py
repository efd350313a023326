"""The reference pages of kinds and of plots, made from their specifications."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any

from vines.pipeline import KINDS, Kind
from vines.stages.api._declarable import default_shown, describe_kind, describe_plot, list_kinds, list_plots

__all__ = ["reference_kinds", "reference_plots"]

_HEAD = """\
# Reference: the {what}s

{about}

Made from the {what}s themselves by `vines {what}s --markdown > docs/reference_{what}s.md`; don't edit it by hand.
"""
_KINDS = """\
Every kind of stage that a study may have, with all options.
[pipelines.md](pipelines.md) explains declarations and the keys that all kinds share: `kind`, `params`, `vary`, `zip`,
`refine`, `carry`, `needs`, `system`, `physical`, `link`. Parameters and options are those for the VI-NES; with another
system parameters are those of the system, `start` has its names, and points take `harvest`."""
_PLOTS = """\
Every plot that a figure may be, with all options.
A stage of the kind `figure` names a plot as `plot = "..."` and the stages that it draws as `needs = [...]`;
[pipelines.md](pipelines.md) explains how."""


def reference_kinds() -> str:
    """Return the page of all kinds, in Markdown.

    Examples
    --------
    >>> reference_kinds().splitlines()[0]
    '# Reference: the kinds'
    """
    parts = [_HEAD.format(what="kind", about=_KINDS)]
    for row in list_kinds():
        found = describe_kind(row["name"])
        parts += [*_section(found), *_facts(KINDS.get(row["name"])), *_table(found["options"])]
    return "\n".join(parts)


def reference_plots() -> str:
    """Return the page of all plots, in Markdown.

    Examples
    --------
    >>> reference_plots().splitlines()[0]
    '# Reference: the plots'
    """
    parts = [_HEAD.format(what="plot", about=_PLOTS)]
    for row in list_plots():
        found = describe_plot(row["name"])
        parts += [*_section(found), *_table(found["options"])]
    return "\n".join(parts)


def _section(found: dict[str, Any]) -> list[str]:
    summary = found["summary"][:1].upper() + found["summary"][1:]
    return [f"## {found['name']}", "", f"{summary}.", "", found["description"].replace("``", "`"), ""]


def _facts(kind: Kind) -> Iterator[str]:
    """Yield what a kind takes and makes, beside its options."""
    if kind.parameters:
        listed = (f"`{name}`{'' if value is None else f' = {value:.10g}'}" for name, value in kind.parameters.items())
        yield f"- parameters: {', '.join(listed)}"
    if kind.systems:
        yield f"- systems: {', '.join(f'`{name}`' for name in (kind.system, *kind.systems))} ([systems.md](systems.md))"
    varies = {"grid": "values, over which it makes a grid", "range": "a range"}
    if kind.vary in varies:
        yield f"- `vary.X`: {varies[kind.vary]}{'; `carry` is allowed' if kind.carry else ''}"
    if kind.needs:
        yield "- `needs`: the stages whose results it takes"
    made = [f"table `{name}`" for name in kind.tables]
    made += [
        word for word, there in (("MCAP logs", kind.logs), ("`picture.png`, `.svg`, `.pdf`", kind.pictures)) if there
    ]
    yield f"- makes: {', '.join(made)}"
    yield ""


def _table(options: Iterable[dict[str, Any]]) -> Iterator[str]:
    rows = [(f"`{row['option']}`", row["type"], default_shown(row), row["meaning"]) for row in options]
    if not rows:
        yield "No options.\n"
        return
    yield "| option | type | default | meaning |"
    yield "|---|---|---|---|"
    for row in rows:
        yield "| " + " | ".join(cell.replace("|", "\\|") for cell in row) + " |"
    yield ""
