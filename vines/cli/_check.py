"""``vines check``: do the results reproduce what was published?"""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator, Mapping, Sequence
from itertools import groupby
from typing import Any

import click

from vines.cli._study import the_study

Row = Mapping[str, Any]


@click.command("check")
@click.argument("name", required=False)
@click.option("--json", "as_json", is_flag=True, help="For machines.")
@click.option("--markdown", "as_markdown", is_flag=True, help="As the page docs/claims.md.")
def command(name: str | None, as_json: bool, as_markdown: bool) -> None:
    """Do the results reproduce the published values? One row each; exit 1 when one misses its tolerance.

    The rows come from the stages of kind "check" of the pipeline or collection NAME, or of all pipelines that have
    been run. A difference that is known and explained still counts: the exit code is 1, and the last line says how
    many are known. ("vines verify" asks something else: whether the stored results are intact.)
    """
    from vines.stages import checks

    if as_json and as_markdown:
        raise click.UsageError("--json and --markdown exclude each other; give one")
    rows = checks(name, study=the_study())
    if as_json:
        click.echo(json.dumps(rows, indent=2))
    elif as_markdown:
        click.echo("\n".join(page(rows)))
    else:
        _show(rows)
    if any(row["verdict"] == "differs" for row in rows):
        sys.exit(1)


def _show(rows: Sequence[Row]) -> None:
    from vines.cli._layout import print_rows

    print_rows(
        ["check", "source", "statement", "published", "ours", "tolerance", "verdict"],
        [[r["id"], r["source"], r["statement"], r["published"], r["ours"], r["tolerance"], outcome(r)] for r in rows],
        wrap=2,
    )
    for row in rows:
        told = "; ".join(text for text in (row["detail"], row["remark"]) if text)
        if told and row["verdict"] != "reproduced":
            click.echo(f"\n{row['id']}: {told}")
    click.echo(f"\n{summary(rows)}")


def outcome(row: Row) -> str:
    """Return the verdict, with the reason of a difference.

    Examples
    --------
    >>> outcome({"verdict": "differs", "reason": "misprint"})
    'differs (misprint)'
    """
    return f"{row['verdict']} ({row['reason']})" if row["reason"] else str(row["verdict"]).replace("_", " ")


def summary(rows: Sequence[Row]) -> str:
    """Return how many values were reproduced, and of the others how many are explained.

    Examples
    --------
    >>> summary([{"verdict": "reproduced", "reason": None}, {"verdict": "differs", "reason": "misprint"}])
    '1 of 2 reproduced; 1 differs, for a known reason (1 misprint)'
    """
    differ = [row["reason"] for row in rows if row["verdict"] == "differs"]
    impossible = sum(row["verdict"] == "not_reproducible" for row in rows)
    parts = [f"{len(rows) - len(differ) - impossible} of {len(rows)} reproduced"]
    if differ:
        strange = differ.count("unexplained")
        known = sorted(set(differ) - {"unexplained"})
        verb = "differs" if len(differ) == 1 else "differ"
        if known:
            counts = ", ".join(f"{differ.count(reason)} {reason}" for reason in known)
            every = f"{len(differ)} {verb}" + (f", {len(differ) - strange} of them" if strange else ",")
            parts.append(f"{every} for a known reason ({counts})")
        if strange:
            parts.append(f"{strange} UNEXPLAINED" if known else f"{strange} {verb}, UNEXPLAINED")
    if impossible:
        parts.append(f"{impossible} not reproducible")
    return "; ".join(parts)


def page(rows: Sequence[Row]) -> Iterator[str]:
    """Yield the lines of docs/claims.md: a table a pipeline, and under it what explains each difference."""
    yield "# What the paper claims, and what comes out"
    yield ""
    yield "Made by `vines run paper && vines check paper --markdown > docs/claims.md`; do not edit. The claims, and the"
    yield "queries that find our values, are in `pipelines/claims.toml`; docs/tables.md says what the verdicts mean. A"
    yield "published number is reproduced when ours lies within the tolerance, which is the precision of the print."
    yield ""
    yield f"**{summary(rows)}.**"
    for pipeline, members in groupby(rows, key=lambda row: row["pipeline"]):
        listed = list(members)
        yield ""
        yield f"## {pipeline}"
        yield ""
        yield "| claim | where | statement | published | ours | tolerance | verdict |"
        yield "|---|---|---|---|---|---|---|"
        for r in listed:
            cells = (f"`{r['id']}`", r["source"], r["statement"], r["published"], r["ours"], r["tolerance"], outcome(r))
            yield "| " + " | ".join("" if c is None else f"{c}".replace("|", "\\|") for c in cells) + " |"
        yield ""
        for r in listed:
            told = "; ".join(text for text in (r["detail"], r["remark"]) if text)
            if told:
                yield f"- `{r['id']}`: {told}."
