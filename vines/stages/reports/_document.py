"""A document of headings, paragraphs, tables and pictures, as HTML for screen and paper, as Markdown, or as PDF."""

from __future__ import annotations

import base64
import shutil
import subprocess
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from html import escape
from pathlib import Path

from vines.errors import FileMissingError, ParameterError
from vines.stages.reports._assets import html_page
from vines.store import write_text

__all__ = ["FORMS", "Heading", "Picture", "Table", "write_document"]

FORMS = (".html", ".pdf", ".md")
"""Suffixes of documents."""

_BROWSERS = ("chromium", "chromium-browser", "google-chrome")

_STYLE = """
@page { size: A4; margin: 14mm 13mm; }
body { font: 10pt/1.4 system-ui, "DejaVu Sans", sans-serif; color: #1c1c1c; margin: 0 auto; max-width: 76rem;
  padding: 1rem; }
h1 { font-size: 1.5rem; margin: 0 0 .2rem; } h2 { font-size: 1.05rem; margin: 1.3rem 0 .35rem;
  border-bottom: 1px solid #c9c9c4; break-after: avoid; } p { margin: .25rem 0 .5rem; }
table { border-collapse: collapse; font-size: .76rem; font-variant-numeric: tabular-nums; width: 100%;
  margin-bottom: .6rem; }
th, td { text-align: left; padding: .14rem .45rem; border-bottom: 1px solid #deded9; vertical-align: top; }
th { border-bottom: 1px solid #777; } tr { break-inside: avoid; } td.number, th.number { text-align: right;
  white-space: nowrap; } td.short { white-space: nowrap; } td.long { min-width: 8rem; }
  td.code { font: .75rem ui-monospace, monospace; overflow-wrap: anywhere; }
.agree, .ok, .yes { color: #17703a; } .disagree, .failed, .no { color: #a8071a; }
.undecidable, .pattern_only { color: #7a5200; } figure { margin: .4rem 0; break-inside: avoid; }
figure img { width: 100%; } figcaption { font-size: .8rem; color: #5c5c5c; }
@media screen { table { display: block; overflow-x: auto; } }
@media print { body { padding: 0; max-width: none; font-size: 9pt; } table { font-size: 6.6pt; }
  th, td { padding: .1rem .25rem; } td.long { min-width: 4rem; } }
"""
_POLICY = "default-src 'none'; img-src data:; style-src 'unsafe-inline'"


@dataclass(frozen=True, slots=True)
class Heading:
    """A heading with the paragraphs below it."""

    text: str
    below: Sequence[str] = ()


@dataclass(frozen=True, slots=True)
class Table:
    """A table: heads, and cells as texts."""

    head: Sequence[str]
    rows: Sequence[Sequence[str]]


@dataclass(frozen=True, slots=True)
class Picture:
    """A picture with its title, as SVG."""

    title: str
    svg: bytes


def write_document(path: Path, title: str, below: str, parts: Sequence[Heading | Table | Picture]) -> None:
    """Write a document in the form that its suffix says; pictures of Markdown go to a folder beside it.

    Raises
    ------
    ParameterError
        If the suffix is none of `FORMS`.
    FileMissingError
        If the folder does not exist, or for PDF no Chromium is there to print it.
    """
    if path.suffix.lower() not in FORMS:
        raise ParameterError(f"{path}: a report ends in {', '.join(FORMS)}, not in {path.suffix or 'nothing'}")
    if not path.absolute().parent.is_dir():
        raise FileMissingError(f"{path}: the folder {path.absolute().parent} does not exist; make it first")
    if path.suffix.lower() == ".md":
        _write_markdown(path, title, below, parts)
    elif path.suffix.lower() == ".html":
        write_text(path, _html(title, below, parts))
    else:
        _print(path, _html(title, below, parts))


def _print(path: Path, page: str) -> None:
    program = next(filter(None, map(shutil.which, _BROWSERS)), None)
    if program is None:
        raise FileMissingError(
            f"{path}: Chromium prints PDF, but there is none ({', '.join(_BROWSERS)}); install it, or write .html"
        )
    with tempfile.TemporaryDirectory() as folder:
        source, made = Path(folder) / "report.html", Path(folder) / "report.pdf"
        source.write_text(page, encoding="utf-8")
        asked = [program, "--headless=new", "--no-sandbox", "--disable-gpu", "--no-pdf-header-footer"]
        asked += [f"--user-data-dir={folder}/profile", f"--print-to-pdf={made}", source.as_uri()]
        try:
            subprocess.run(asked, check=True, capture_output=True, timeout=300)
        except (subprocess.CalledProcessError, subprocess.TimeoutExpired) as error:
            raise FileMissingError(f"{path}: {program} did not print it ({error}); write .html") from None
        if not made.is_file():
            raise FileMissingError(f"{path}: {program} printed nothing; write .html and print that")
        partial = path.with_name(f".{path.name}.part")
        shutil.copyfile(made, partial)
        partial.replace(path)


def _html(title: str, below: str, parts: Sequence[Heading | Table | Picture]) -> str:
    body = "\n".join([f"<h1>{escape(title)}</h1>", f"<p>{escape(below)}</p>", *map(_part, parts)])
    return html_page(escape(title), _POLICY, _STYLE, body)


def _part(part: Heading | Table | Picture) -> str:
    if isinstance(part, Heading):
        return f"<h2>{escape(part.text)}</h2>" + "".join(f"<p>{escape(text)}</p>" for text in part.below)
    if isinstance(part, Picture):
        data = base64.b64encode(part.svg).decode()
        title = escape(part.title)
        shown = f'<img alt="{title}" src="data:image/svg+xml;base64,{data}">'
        return f"<figure>{shown}<figcaption>{title}</figcaption></figure>"
    numeric = [all(_is_number(row[k]) for row in part.rows) for k in range(len(part.head))]
    heads = "".join(
        f"<th{' class=number' if number else ''}>{escape(text)}</th>"
        for text, number in zip(part.head, numeric, strict=True)
    )
    rows = []
    for row in part.rows:
        cells = []
        for text, number in zip(row, numeric, strict=True):
            kind = (
                "number"
                if number
                else "short"
                if len(text) < _SHORT
                else "code"
                if len(text) > _DIGEST and " " not in text
                else "long"
            )
            word = text.replace(" ", "_")
            kind += f" {word}" if word in _COLOURED else ""
            cells.append(f'<td class="{kind.strip()}">{escape(text)}</td>' if kind else f"<td>{escape(text)}</td>")
        rows.append(f"<tr>{''.join(cells)}</tr>")
    return f"<table><thead><tr>{heads}</tr></thead><tbody>{''.join(rows)}</tbody></table>"


_COLOURED = ("agree", "disagree", "undecidable", "pattern_only", "ok", "failed", "yes", "no")


_SHORT = 14
"""Characters of a cell that is not broken into lines."""

_DIGEST = 60
"""Characters of a cell without blanks that is a digest."""


def _is_number(text: str) -> bool:
    first = text.partition("(")[0]
    try:
        float(first)
    except ValueError:
        return text == ""
    return True


def _write_markdown(path: Path, title: str, below: str, parts: Sequence[Heading | Table | Picture]) -> None:
    lines = [f"# {title}", "", below, ""]
    folder = path.with_name(f"{path.stem}_figures")
    count = 0
    for part in parts:
        if isinstance(part, Heading):
            lines += [f"## {part.text}", "", *(line for text in part.below for line in (text, ""))]
        elif isinstance(part, Picture):
            count += 1
            folder.mkdir(exist_ok=True)
            (folder / f"{count}.svg").write_bytes(part.svg)
            lines += [f"![{part.title}]({folder.name}/{count}.svg)", ""]
        else:
            lines += ["| " + " | ".join(part.head) + " |", "|" + " --- |" * len(part.head)]
            lines += ["| " + " | ".join(text.replace("|", "\\|") for text in row) + " |" for row in part.rows]
            lines.append("")
    write_text(path, "\n".join(lines))
