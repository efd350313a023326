"""The page that explains an export to whoever finds it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from vines import schema
from vines.catalogue._study import LICENCES, Deposit
from vines.store import Result

__all__ = ["readme"]

_HEAD = """\
# {title}

{study}Simulations and periodic orbits of a vibro-impact nonlinear energy sink, with units and provenance. Everything is
dimensionless after the paper "Maps unlock the full dynamics of targeted energy transfer via a vibro-impact nonlinear
energy sink" unless a unit is told. `w = x1 - x2` is the gap; `w = +1` is an impact on the left end of the cavity.

## Opening it

The tables are Parquet files and need nothing but a reader of them:

```python
import pandas
pandas.read_parquet("tables/{first}.parquet")
```

`load.sql` makes views over all of them in any DuckDB, one a table over all stages, and one a stage
(`"<pipeline>.<stage>"`, without quotes `<pipeline>.<stage>`). In a shell, in this folder:

```
duckdb -init load.sql
```

From Python, in any folder:

```python
import duckdb
connection = duckdb.connect()
connection.execute("SET file_search_path = '/path/to/this/folder'")
connection.execute(open("/path/to/this/folder/load.sql").read())
connection.sql("select pipeline, stage, count(*) from points group by all")
```

## What is here

| | |
|---|---|
| `tables/` | the tables, one file a stage and table, sorted by the axes of the stage |
| `figures/` | the pictures made of them, PNG, SVG and PDF |
| `logs/` | MCAP logs of single runs{logs} |
| `load.sql` | the views |
| `dictionary.csv`, `schemas/` | every column with type, unit, description, source and allowed values |
| `provenance/` | for each stage its kind, options, parameters, digest of the code, versions, checksums |
| `declarations/` | the declared pipelines and published values |
| `datapackage.json` | the same as a Data Package (Frictionless) |{datacite}
| `SHA256SUMS` | checksums of all files: `sha256sum -c SHA256SUMS` |
| `LICENSE`, `CITATION.cff` | how it may be used, and how to cite it |

Units stand in the metadata of each column, in the JSON text under the key `vines` of each file's metadata, and in
`dictionary.csv`.
"""


def readme(
    results: Sequence[tuple[str, str, Result]],
    titles: Mapping[str, str],
    logs: bool,
    stale: Sequence[str] = (),
    deposit: Deposit | None = None,
) -> str:
    """Return the text of README.md.

    Parameters
    ----------
    results : sequence of (str, str, Result)
        Pipeline, stage, result.
    titles : mapping of str to str
        Title of each pipeline.
    logs : bool
        Whether the logs are there.
    stale : sequence of str
        Stages that are declared otherwise now.
    deposit : Deposit, optional
        What the study tells a data repository.
    """
    files = [f"{pipeline}.{stage}.{name}" for pipeline, stage, result in results for name in result.tables]
    text = _HEAD.replace("{first}", files[0] if files else "<pipeline>.<stage>.<table>")
    of_datacite = "\n| `datacite.json` | title, creators, licence and so on for a repository (DataCite 4.5) |"
    text = text.replace("{datacite}", of_datacite if deposit is not None else "")
    text = text.replace("{title}", "Results of vines" if deposit is None else deposit.title)
    text = text.replace("{study}", "" if deposit is None else _about(deposit))
    lines = [text.replace("{logs}", "" if logs else ": not part of this export")]
    if stale:
        lines += ["## Not as declared", "", "`declarations/` asks for more or something else than what is here:", ""]
        lines += [*(f"- {each}" for each in stale), ""]
    lines += ["## Tables", ""]
    rows: dict[str, int] = {}
    for _, _, result in results:
        for name, about in result.manifest["tables"].items():
            rows[name] = rows.get(name, 0) + about["rows"]
    lines += ["| table | rows | a row is |", "|---|---|---|"]
    lines += [f"| `{name}` | {count} | {schema.table(name).description} |" for name, count in sorted(rows.items())]
    lines += ["", "## Stages", "", "| stage | kind | tables |", "|---|---|---|"]
    last = ""
    for pipeline, stage, result in results:
        if pipeline != last:
            lines.append(f"| **{pipeline}** | | {titles.get(pipeline, '')} |")
            last = pipeline
        tables = ", ".join(f"{name} ({about['rows']})" for name, about in result.manifest["tables"].items())
        lines.append(f"| `{pipeline}.{stage}` | {result.manifest['kind']} | {tables} |")
    return "\n".join(lines) + "\n"


def _about(deposit: Deposit) -> str:
    """Return who made a study, what it is, and how it may be used."""
    name, address = LICENCES[deposit.licence]
    said = [
        "; ".join(creator.name for creator in deposit.creators) + f". Version {deposit.version}.",
        *([deposit.description] if deposit.description else []),
        f"Licence of the data: [{name}]({address}). To cite them: `CITATION.cff`.",
    ]
    return "\n\n".join(said) + "\n\n"
