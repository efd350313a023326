"""``vines export DIR``: a copy of the results that needs no vines."""

from __future__ import annotations

import json
from pathlib import Path

import click

from vines.cli._study import the_study


@click.command("export")
@click.argument("folder", metavar="DIR", type=click.Path(path_type=Path))
@click.argument("names", nargs=-1, metavar="[NAME]...")
@click.option("--logs", is_flag=True, help="Take the MCAP logs along.")
@click.option("--licence", type=click.Path(path_type=Path), help="Text that becomes LICENSE; else that of the project.")
@click.option("--citation", type=click.Path(path_type=Path), help="CITATION.cff; else that of the project.")
@click.option("--json", "as_json", is_flag=True, help="For machines.")
def command(
    folder: Path, names: tuple[str, ...], logs: bool, licence: Path | None, citation: Path | None, as_json: bool
) -> None:
    """Copy the results of the pipelines NAME, or of all that were run, into the empty or new folder DIR.

    It has the tables as Parquet, load.sql that makes their views in any DuckDB, pictures, schemas, a data dictionary,
    provenance, declarations, licence, citation, and checksums: fit for a data repository, and for pandas and polars.

    \b
    vines export results-2026 paper
    cd results-2026 && sha256sum -c SHA256SUMS && duckdb -init load.sql
    """  # noqa: D301
    from vines.stages import export

    files = export(folder, *names, logs=logs, licence=licence, citation=citation, study=the_study())
    size = sum((folder / name).stat().st_size for name in files)
    if as_json:
        click.echo(json.dumps({"folder": str(folder), "files": files, "bytes": size}, indent=2))
        return
    click.echo(f"{folder}: {len(files)} files, {size / 1e6:.1f} MB; begin with {folder / 'README.md'}")
    if "datacite.json" not in files and licence is None:
        click.echo("no [study] is declared: licence and citation are those of the project, of vines where it has none")
