"""``vines query``: SQL over the catalogue."""

from __future__ import annotations

import os
import re
import tempfile
from pathlib import Path

import click
import msgspec

from vines.cli._study import the_study
from vines.errors import QueryError

SUFFIXES = {".csv": "csv", ".json": "json", ".parquet": "parquet"}


_COMMENT = re.compile(r"--[^=\s]*\s")
"""How SQL starts that starts with a comment; the value of an option has a sign before it, or an argument of its own."""


class _Query(click.Command):
    """The command, to which SQL that starts with a comment is no option."""

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Let such SQL stand after all options."""
        found = [each for each in args if _COMMENT.match(each)] if "--" not in args else []
        return super().parse_args(ctx, [*(each for each in args if each not in found), "--", *found] if found else args)


@click.command("query", cls=_Query)
@click.argument("sql")
@click.option(
    "--format",
    "form",
    type=click.Choice(["table", "csv", "json", "parquet"]),
    help="How to write the answer; the default follows the suffix of --out, else table.",
)
@click.option("--out", type=click.Path(dir_okay=False, path_type=Path), help="Write to this file, not the screen.")
def command(sql: str, form: str | None, out: Path | None) -> None:
    """Ask the result tables in SQL (DuckDB's dialect).

    \b
    vines query "select A, name, kinetic_ratio from points where stage = 'up'"
    vines query "select * from bifurcations" --out bifurcations.csv

    Exit code 1 if the answer is without results that are damaged, which are named.
    """  # noqa: D301
    sql = os.fsencode(sql).decode("utf-8", "replace")  # where the locale is C, Python takes letters for single bytes

    if form is None and out is not None and out.suffix not in {*SUFFIXES, ".txt"}:
        allowed = ".csv, .json, .parquet, .txt"
        raise QueryError(
            f"--out {out}: the suffix {out.suffix!r} names no format; allowed: {allowed}; or give --format"
        )
    _answer(sql, form, out)
    if out is not None:
        click.echo(f"wrote {out}  ({out.stat().st_size / 1e3:.0f} kB)")


def _answer(sql: str, form: str | None, out: Path | None) -> None:
    """Print or write the answer."""
    from vines.stages import rows_of, save_query

    study = the_study()
    form = form or (SUFFIXES.get(out.suffix, "table") if out is not None else "table")
    match form:
        case "csv" | "parquet" if out is not None:
            save_query(sql, out, form, study=study)
        case "parquet":
            raise QueryError("--format parquet needs --out FILE: a terminal cannot show it")
        case "csv":
            with tempfile.TemporaryDirectory() as folder:
                save_query(sql, Path(folder) / "answer.csv", "csv", study=study)
                click.echo((Path(folder) / "answer.csv").read_text("utf-8"), nl=False)
        case "json":
            names, rows = rows_of(sql, study=study)
            names = _distinct(names)
            encoder = msgspec.json.Encoder(enc_hook=str, decimal_format="number")
            found = encoder.encode([dict(zip(names, row, strict=True)) for row in rows])
            _put(msgspec.json.format(found, indent=1).decode(), out)
        case _:
            from vines.cli._layout import lines

            _put("\n".join(lines(*rows_of(sql, study=study), wrap=None)), out)


def _put(text: str, out: Path | None) -> None:
    if out is None:
        click.echo(text)
    elif not out.parent.is_dir():
        raise QueryError(f"{out}: the folder {out.parent} does not exist; make it first")
    else:
        out.write_text(text + "\n", encoding="utf-8")


def _distinct(names: list[str]) -> list[str]:
    """Return names of columns such that a mapping holds all of them.

    Examples
    --------
    >>> _distinct(["A", "A", "A_1", "A"])
    ['A', 'A_2', 'A_1', 'A_3']
    """
    found: list[str] = []
    for place, name in enumerate(names):
        new, count = name, 1
        while new in found or (new != name and new in names[place:]):
            new, count = f"{name}_{count}", count + 1
        found.append(new)
    return found
