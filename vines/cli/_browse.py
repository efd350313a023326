"""``vines browse``: all logs of the catalogue as a table in the Rerun viewer."""

from __future__ import annotations

import click

from vines.cli._study import the_study


@click.command("browse")
@click.argument("logs", nargs=-1, metavar="[LOG...]")
@click.option("--web", is_flag=True, help="Serve the web viewer on 127.0.0.1 instead of opening a window.")
def command(logs: tuple[str, ...], web: bool) -> None:
    """Browse logs as a table with parameters and attractor names as columns; a row opens as a run.

    Without LOG all logs of the catalogue; else <pipeline>.<stage>, a log id, or the path of an MCAP file. It serves on
    127.0.0.1 until the window is closed, or until Ctrl-C.

    \b
    vines browse
    vines browse quickstart.asymmetric_run --web
    """  # noqa: D301
    from vines import viewer
    from vines.stages import all_logs, find_logs, recordings_folder, stages_of_logs

    study = the_study()
    paths = [path for name in logs for path in find_logs(name, study=study)] if logs else all_logs(study=study)
    stages = stages_of_logs(study=study)
    viewer.browse(paths, recordings_folder(study=study), stages=stages, web=web, tell=click.echo)
