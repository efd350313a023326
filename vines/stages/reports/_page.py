"""The report as one HTML page that needs nothing else: what is told becomes text, figures become images inside it."""

from __future__ import annotations

import base64
import math
import re
import struct
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from html import escape, unescape
from typing import Any

from vines import schema
from vines.stages.reports._assets import POLICY, SCRIPT, STYLE, html_page

__all__ = ["Figure", "Head", "Run", "Section", "StageFacts", "page", "plain"]

_SIGNS = {
    **{"reproduced": "✓", "differs": "✗", "not_reproducible": "–"},
    **{"agree": "✓", "pattern_only": "~", "disagree": "✗", "undecidable": "–"},
}
_SIZE = re.compile(rb'viewBox="0 0 ([\d.]+) ([\d.]+)"')


@dataclass(frozen=True, slots=True)
class Figure:
    """A picture: the stage that made it, its title, its file, and what the file is: svg, png or pdf."""

    stage: str
    title: str
    data: bytes
    format: str


@dataclass(frozen=True, slots=True)
class Head:
    """The first rows of a table: its view, its name in ``schemas/``, how many rows it has, columns and rows."""

    view: str
    table: str
    total: int
    columns: Sequence[str]
    rows: Sequence[Sequence[Any]]


@dataclass(frozen=True, slots=True)
class Run:
    """A logged run: what ``vines view`` calls it, what it is, and where the log lies, as seen from the page."""

    log: str
    name: str
    link: str


@dataclass(frozen=True, slots=True)
class StageFacts:
    """What is told of a stage: kind, points, failures, size [B], time [s], and its provenance by name."""

    name: str
    kind: str
    points: int
    failed: int
    size: int
    seconds: float | None
    provenance: Mapping[str, str]


@dataclass(frozen=True, slots=True)
class Section:
    """A pipeline."""

    name: str
    title: str
    source: str
    figures: Sequence[Figure]
    checks: Sequence[Mapping[str, Any]]
    comparisons: Sequence[Mapping[str, Any]]
    runs: Sequence[Run]
    tables: Sequence[Head]
    stages: Sequence[StageFacts]
    missing: Sequence[str] = ()
    """What it is without, and why, a line each."""


def plain(title: str) -> str:
    r"""Return the title of a picture without the marks of its mathematics.

    Examples
    --------
    >>> plain(r"Fig. 2:  $\mu = 0.01$,  $\Omega = 1$")
    'Fig. 2: μ = 0.01, Ω = 1'
    """
    letters = re.sub(r"\\([A-Za-z]+)", lambda found: unescape(f"&{found[1]};"), title)  # TeX and HTML name them alike
    return " ".join(letters.replace("$", "").split())


def page(name: str, title: str, source: str, sections: Sequence[Section]) -> str:
    """Return the page.

    Parameters
    ----------
    name, title, source : str
        Of the pipeline, or the collection, that is reported.
    sections : sequence of Section
        Its pipelines; a table of contents stands before more than one.
    """
    parts = [
        f"<h1>{escape(title or name)}</h1>",
        f'<p class="dim">{escape(source)}{" · " if source else ""}<code>vines report {escape(name)}</code></p>',
        _overview(sections),
    ]
    if len(sections) > 1:
        parts.append(_contents(sections))
    parts += [_section(section, alone=len(sections) == 1) for section in sections]
    body = f"<main>\n{chr(10).join(parts)}\n</main>\n<script>{SCRIPT}</script>"
    return html_page(escape(title or name), escape(POLICY), STYLE, body)


def _overview(sections: Sequence[Section]) -> str:
    checks = Counter(check["verdict"] for section in sections for check in section.checks)
    verdicts = Counter(
        row["verdict"]
        for section in sections
        for row in section.comparisons
        if row["basis"] == "measured" and row["rank"] == 0
    )
    stages = [stage for section in sections for stage in section.stages]
    figures = sum(len(section.figures) for section in sections)
    seconds = [stage.seconds for stage in stages if stage.seconds is not None]
    cards = [
        (f"{checks['reproduced']} of {checks.total()}", "published values reproduced") if checks else None,
        (f"{verdicts['agree']} of {verdicts.total()}", "runs of a rig agree with the model") if verdicts else None,
        (str(figures), "figure" if figures == 1 else "figures"),
        (f"{sum(head.total for section in sections for head in section.tables):,}", "rows in tables"),
        (_bytes(sum(stage.size for stage in stages)), "stored"),
        (_time(sum(seconds)), "computed, when it was last done") if seconds else None,
    ]
    told = "".join(f"<div><b>{escape(card[0])}</b>{escape(card[1])}</div>" for card in cards if card)
    return f'<div class="cards">{told}</div>'


def _contents(sections: Sequence[Section]) -> str:
    items = []
    for section in sections:
        verdicts = Counter(check["verdict"] for check in section.checks)
        told = f"{verdicts['reproduced']}/{verdicts.total()} reproduced" if verdicts else "no checks"
        items.append(
            f'<li><a href="#{escape(section.name)}">{escape(section.name)}: {escape(section.title)}</a> '
            f'<span class="dim">{told}</span></li>'
        )
    return f'<nav aria-label="Contents"><ol>{"".join(items)}</ol></nav>'


def _section(section: Section, *, alone: bool) -> str:
    head = "" if alone else f"<h2>{escape(section.name)}: {escape(section.title)}</h2>"
    if not alone and section.source:
        head += f'<p class="dim">{escape(section.source)}</p>'
    head += "".join(f"<p><strong>Not on this page:</strong> {escape(each)}</p>" for each in section.missing)
    parts = [head]
    if section.comparisons:
        parts.append(_comparisons(section))
    parts += map(_figure, section.figures)
    if section.checks:
        parts.append(_checks(section))
    if section.runs:
        parts.append(_runs(section.runs))
    if section.tables:
        parts.append("<h3>Tables</h3>")
        parts += [_head(section.name, number, head) for number, head in enumerate(section.tables)]
    parts += ["<h3>Stages and their origin</h3>", _stages(section)]
    return f'<section id="{escape(section.name)}">{"".join(parts)}</section>'


def _figure(figure: Figure) -> str:
    if figure.format == "pdf":
        told = f"{escape(plain(figure.title))} <code>{escape(figure.stage)}.pdf</code>"
        return f"<figure><figcaption><span>{told}</span></figcaption></figure>"
    if figure.format == "png":
        width, height = struct.unpack(">II", figure.data[16:24])  # of its first chunk, IHDR
        ratio = width / height
    else:
        found = _SIZE.search(figure.data)
        ratio = float(found[1]) / float(found[2]) if found else 1.5
    kind = {"svg": "image/svg+xml", "png": "image/png"}[figure.format]
    data = base64.b64encode(figure.data).decode()
    buttons = "".join(
        f'<button class="tool" data-act="{act}" aria-label="{label}">{sign}</button>'
        for act, label, sign in (("out", "smaller", "−"), ("in", "larger", "+"), ("reset", "whole figure", "⤢"))
    )
    title = escape(plain(figure.title))
    return (
        f'<figure><div class="frame" tabindex="0" role="group" '
        f'aria-label="{title}; + and - zoom, arrows move, 0 resets">'
        f'<img alt="{title}" data-ratio="{ratio:.6f}" draggable="false" src="data:{kind};base64,{data}"></div>'
        f"<figcaption><span>{title} <code>{escape(figure.stage)}</code></span>{buttons}</figcaption></figure>"
    )


def _checks(section: Section) -> str:
    names = ("id", "source", "statement", "published", "ours", "tolerance", "verdict", "reason", "remark", "detail")
    rows = []
    for check in section.checks:
        cells = []
        for name in names:
            value = check.get(name)
            if name == "verdict":
                cells.append(_verdict(str(value)))
            else:
                wide = ' class="wide"' if name in ("statement", "remark", "detail") else ""
                cells.append(f"<td{wide}>{escape(_cell(value))}</td>")
        rows.append(f"<tr>{''.join(cells)}</tr>")
    counts = Counter(check["verdict"] for check in section.checks)
    told = ", ".join(f"{count} {name.replace('_', ' ')}" for name, count in sorted(counts.items(), reverse=True))
    table = _table(f"{section.name}-checks", [(name, "") for name in names], rows)
    tools = _tools(f"{section.name}-checks", f"{section.name}.checks.csv")
    return f"<h3>Published values: {told}</h3>{tools}{table}"


def _comparisons(section: Section) -> str:
    """Return the verdicts on the runs of a rig, those at measured parameters and those at calibrated ones apart."""
    parts = []
    for basis in ("measured", "calibrated"):
        mine = [row for row in section.comparisons if row["basis"] == basis and row["rank"] == 0]
        if not mine:
            continue
        counts = Counter(row["verdict"] for row in mine)
        told = ", ".join(f"{count} {verdict.replace('_', ' ')}" for verdict, count in sorted(counts.items()))
        note = ""
        if basis == "calibrated":
            first = mine[0]
            factors = f"Omega × {first['calibrated_Omega']:.6f}, A × {first['calibrated_A']:.5f}"
            added = f"r {'+' if first['calibrated_r'] >= 0 else '−'} {abs(first['calibrated_r']):.5f}"
            told_on = f"Calibrated on {first['calibrated_on']}: {factors}, {added}"
            note = f"<p>{escape(told_on)}; scored on the other runs only.</p>"
        name = f"{section.name}-{basis}"
        table = _table(name, [(column, "") for column in _COMPARED], [_compared(row) for row in mine])
        file = f"{section.name}.comparisons.{basis}.csv"
        parts.append(f"<h3>Rig beside the model, {basis} parameters: {told}</h3>{note}{_tools(name, file)}{table}")
    return "".join(parts)


_COMPARED = (
    *("run_id", "A", "pattern", "branch", "verdict", "reason", "E_n_phase", "E_n_max_abs_x1", "E_n_kinetic_ratio"),
    *("rms_w", "rms_w_dot", "holding", "protocol"),
)


def _why(row: Mapping[str, Any]) -> str:
    """Return the reason of a verdict; where it lists every E_n, which have columns of their own, only those above 1."""
    if row["verdict"] not in ("agree", "pattern_only"):
        return str(row["reason"])
    above = [f"E_n({name}) above 1" for name in ("phase", "max_abs_x1", "kinetic_ratio") if row[f"E_n_{name}"] > 1]
    return ", ".join(above) or "every E_n at most 1"


def _compared(row: Mapping[str, Any]) -> str:
    cells = []
    for name in _COMPARED:
        value = _why(row) if name == "reason" else row[name]
        if name == "verdict":
            cells.append(_verdict(str(value)))
        elif isinstance(value, float):
            cells.append(f'<td class="number" data-value="{value!r}">{value:.4g}</td>')
        else:
            wide = ' class="wide"' if name == "reason" else ""
            cells.append(f"<td{wide}>{escape(_cell(value))}</td>")
    return f"<tr>{''.join(cells)}</tr>"


def _verdict(value: str) -> str:
    said = f"{_SIGNS.get(value, '')} {value.replace('_', ' ')}"
    return f'<td class="verdict {escape(value)}" data-value="{escape(value)}">{said}</td>'


def _runs(runs: Sequence[Run]) -> str:
    items = []
    for run in runs:
        command = f"vines view {run.log}"
        items.append(
            f'<li><code>{escape(command)}</code> <button class="tool" data-copy="{escape(command)}">copy</button> '
            f'{escape(run.name)} · <a href="{escape(run.link)}">MCAP log</a></li>'
        )
    return f"<h3>Runs to look at</h3><ul>{''.join(items)}</ul>"


def _head(section: str, number: int, head: Head) -> str:
    units = {column.name: column.unit for column in schema.table(head.table).columns}
    rows = ["<tr>" + "".join(map(_data, row)) + "</tr>" for row in head.rows]
    name = f"{section}-{number}"
    shown = f"{head.total} row{'' if head.total == 1 else 's'}" + (
        f", the first {len(head.rows)}" if head.total > len(head.rows) else ""
    )
    command = f"vines query 'select * from \"{head.view}\"' --out {head.view}.csv"
    copy = f'<button class="tool" data-copy="{escape(command)}">copy the command for all rows</button>'
    table = _table(name, [(column, units.get(column, "")) for column in head.columns], rows)
    return (
        f"<details><summary><code>{escape(head.view)}</code> "
        f'<span class="dim">{shown}</span></summary>{_tools(name, f"{head.view}.csv", copy)}{table}</details>'
    )


def _table(name: str, columns: Iterable[tuple[str, str]], rows: Sequence[str]) -> str:
    heads = "".join(
        f'<th scope="col" data-name="{escape(column)}"><button>{escape(column)}</button>'
        f"{f' <small>{escape(unit)}</small>' if unit and unit != '1' else ''}</th>"
        for column, unit in columns
    )
    return (
        f'<div class="scroll" tabindex="0" role="region" aria-label="{escape(name)}"><table id="{escape(name)}">'
        f"<thead><tr>{heads}</tr></thead><tbody>{''.join(rows)}</tbody></table></div>"
    )


def _tools(name: str, file: str, more: str = "") -> str:
    return (
        f'<div class="tools" data-for="{escape(name)}">'
        '<input type="search" placeholder="filter" aria-label="filter rows">'
        f'<button class="tool" data-csv="{escape(file)}">save these rows as CSV</button>{more}</div>'
    )


def _stages(section: Section) -> str:
    rows = []
    for stage in section.stages:
        told = [stage.name, stage.kind, stage.points, stage.failed, _bytes(stage.size)]
        told.append("" if stage.seconds is None else _time(stage.seconds))
        lines = "".join(f"<dt>{escape(k)}</dt><dd><code>{escape(v)}</code></dd>" for k, v in stage.provenance.items())
        cells = "".join(f"<td>{escape(_cell(value))}</td>" for value in told)
        rows.append(
            f'<tr>{cells}<td class="key wide"><details>'
            f"<summary>{escape(stage.provenance.get('key', '')[:12])}</summary>"
            f"<dl>{lines}</dl></details></td></tr>"
        )
    columns = [(name, "") for name in ("stage", "kind", "points", "failed", "size", "time", "origin")]
    return _table(f"{section.name}-stages", columns, rows)


def _data(value: Any) -> str:
    if isinstance(value, bool) or value is None or not isinstance(value, int | float):
        return f"<td>{escape(_cell(value))}</td>"
    return f'<td class="number" data-value="{value!r}">{escape(_cell(value))}</td>'


def _cell(value: Any) -> str:
    if value is None:
        return ""
    if isinstance(value, float):
        return f"{value:.7g}" if math.isfinite(value) else str(value)
    if isinstance(value, list | tuple):
        shown = [_cell(each) for each in value[:4]]
        return "[" + ", ".join(shown) + (", …" if len(value) > 4 else "") + "]"
    return str(value)


def _bytes(size: int) -> str:
    return f"{size / 1e6:.1f} MB" if size >= 1e5 else f"{size / 1e3:.1f} kB"


def _time(seconds: float) -> str:
    if seconds < 60:
        return f"{seconds:.1f} s"
    return f"{int(seconds) // 60} min {int(seconds) % 60} s"
