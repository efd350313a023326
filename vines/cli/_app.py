"""The command line: its commands, and how it ends.

Subcommands live in modules of their own that are imported when they are called, so that ``vines --help`` is quick.
"""

from __future__ import annotations

import gc
import importlib
import io
import os
import shlex
import sys
import warnings
from functools import partial
from pathlib import Path
from typing import Any

import click

from vines import __version__
from vines.cli._interrupt import stoppable
from vines.cli._supervised import PATIENCE, go_on_in_a_child, is_supervised
from vines.errors import DamageWarning, StaleWarning, VinesError, nearest
from vines.late_pandas import load_pandas_late

__all__ = ["COMMANDS", "LazyGroup", "app", "run"]

# name: (module, one line for --help)
COMMANDS = {
    "init": ("vines.cli._init", "Start a study of your own in a new folder."),
    "list": ("vines.cli._list", "List the pipelines and what they are for."),
    "status": ("vines.cli._status", "Say what is computed, what is stale, and why."),
    "run": ("vines.cli._run", "Compute what a pipeline still lacks."),
    "merge": ("vines.cli._merge", "Put together what shards of a run computed."),
    "graph": ("vines.cli._graph", "Draw a pipeline as a Mermaid flowchart."),
    "kinds": ("vines.cli._kinds", "List the kinds of stages, or the options of one."),
    "plots": ("vines.cli._plots", "List the plots of figures, or the options of one."),
    "tables": ("vines.cli._tables", "List the result tables."),
    "schema": ("vines.cli._schema", "Describe the columns of a table, with units."),
    "query": ("vines.cli._query", "Ask the result tables in SQL."),
    "verify": ("vines.cli._verify", "Are the stored results intact and physically consistent?"),
    "check": ("vines.cli._check", "Do the results reproduce the published values?"),
    "figure": ("vines.cli._figure", "Write a figure as a file for a paper: PDF, SVG or PNG, of any width."),
    "report": ("vines.cli._report", "Write one HTML page: figures, checks, tables, provenance."),
    "export": ("vines.cli._export", "Copy results into a folder that needs no vines."),
    "solve": ("vines.cli._solve", "Print the periodic orbit of a word of impacts."),
    "view": ("vines.cli._view", "Look at logged runs in the Rerun viewer."),
    "browse": ("vines.cli._browse", "Browse all logs as a table in the Rerun viewer."),
    "recover": ("vines.cli._recover", "Save what is intact in a damaged log."),
    "diff": ("vines.cli._diff", "Compare two results, parameters and values."),
    "gc": ("vines.cli._gc", "Remove results that nothing refers to."),
    "rig": ("vines.cli._rig", "Measured data of a rig: ingest, reconstruct, compare; or a synthetic one."),
    "warm-up": ("vines.cli._warm_up", "Compile the kernels now, not at the first run."),
}


INCOMPLETE = 1
"""Exit code where an answer is without results that are damaged."""
_KEEPING = frozenset({"merge", "run"})
"""Commands that keep what they have computed."""
_SERVING = frozenset({"browse", "view"})
"""Commands that a signal is how to end: they end their server in good order."""
_WATCHING = (("rig", "watch"), ("run", "--watch"))
"""Commands that are ended so too where the second word is there: they finish their log, or end their viewer."""
_PROMPT = frozenset({"", "graph", "init", "kinds", "list", "plots", "schema", "tables"})
"""Commands that read or write a few small files, and none: Python hears a signal at once, nobody has to wait for it."""
_SERVER_PATIENCE = 12.0
"""Seconds that they have for it on a busy machine; they take less than one otherwise."""
_THRESHOLDS = (100_000, 50, 100)
"""New objects, and rounds, after which Python looks for cycles; its own are 700, 10, 10."""


class LazyGroup(click.Group):
    """A group that knows the names and summaries of its commands and imports one when it is called.

    Parameters
    ----------
    known : dict of str to (str, str)
        Module, and line for ``--help``, of each command, in the order in which a user meets them.
    """

    def __init__(self, *args: Any, known: dict[str, tuple[str, str]], **kwargs: Any) -> None:
        super().__init__(*args, **kwargs)
        self.known = known

    def list_commands(self, ctx: click.Context) -> list[str]:
        """Return the names of the commands."""
        del ctx
        return list(self.known)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        """Import a command."""
        del ctx
        if cmd_name not in self.known:
            return None
        return importlib.import_module(self.known[cmd_name][0]).command

    def resolve_command(self, ctx: click.Context, args: list[str]) -> Any:
        """Name the nearest command if there is none of that name."""
        if args and args[0] not in self.known and not args[0].startswith("-"):
            raise click.UsageError(f"no command {args[0]!r}: {nearest(args[0], self.known)}", ctx)
        return super().resolve_command(ctx, args)

    def invoke(self, ctx: click.Context) -> Any:
        """Call the command; of an interruption nothing is printed here, where click would print an empty line."""
        try:
            return super().invoke(ctx)
        except KeyboardInterrupt:
            raise click.exceptions.Abort from None

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write the list of commands without importing them."""
        del ctx
        with formatter.section("Commands"):
            formatter.write_dl([(name, line) for name, (_, line) in self.known.items()])


@click.group(cls=LazyGroup, known=COMMANDS, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(__version__, prog_name="vines")
@click.option(
    "--root",
    metavar="DIR",
    type=click.Path(path_type=Path),
    help="Root of the project; else VINES_ROOT, or the nearest parent with pipelines/.",
)
def app(root: Path | None) -> None:
    """Reproducible studies of the vibro-impact nonlinear energy sink.

    \b
    vines run quickstart        compute a first study
    vines list                  see what else there is
    """  # noqa: D301 - click reads \b as "keep these lines"
    del root  # commands ask for it: vines.cli._study


def run(*, supervised: bool) -> None:
    """Run the command line, see :func:`vines.cli.main`."""
    command = next((each for each in sys.argv[1:] if each in COMMANDS), "")
    remedy = f"'{shlex.join(['vines', *sys.argv[1:]])}' goes on" if command in _KEEPING else ""
    if supervised and command not in _PROMPT:
        serving = command in _SERVING or any(command == name and more in sys.argv for name, more in _WATCHING)
        go_on_in_a_child(remedy, patience=_SERVER_PATIENCE if serving else PATIENCE)
    os.environ.setdefault("RERUN_ANALYTICS", "0")
    load_pandas_late()
    # What libraries make at their import lives to the end; to look for cycles there takes a twelfth of a first run.
    gc.set_threshold(*_THRESHOLDS)
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):  # a letter that the terminal does not have is no error
            stream.reconfigure(errors="backslashreplace")
    incomplete: list[str] = []
    try:
        with warnings.catch_warnings(), stoppable(remedy, silent=is_supervised()):
            for ours in (DamageWarning, StaleWarning):
                warnings.simplefilter("always", ours)
            warnings.showwarning = partial(_show, incomplete)
            code = app.main(standalone_mode=False)
    except click.exceptions.NoArgsIsHelpError as error:
        click.echo(error.format_message())
        code = 0
    except click.ClickException as error:
        click.echo(f"vines: {error.format_message()}{_how_to_call(error)}", err=True)
        code = error.exit_code
    except VinesError as error:
        click.echo(f"vines: {error}", err=True)
        code = error.exit_code
    except BrokenPipeError:
        # The reader of our output went away (`vines query … | head`); nothing is wrong.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        code = 0
    except OSError as error:
        # A folder that cannot be made, a full disk, a time-out: ours to tell in a line, not to trace.
        place = f"{error.filename}: " if error.filename else ""
        click.echo(f"vines: {place}{error.strerror or error}{_named(error)}", err=True)
        code = 2
    except MemoryError as error:
        click.echo(f"vines: not enough memory{f': {error}' if str(error) else ''}", err=True)
        code = 2
    sys.exit((code if isinstance(code, int) else 0) or (INCOMPLETE if incomplete else 0))


def _how_to_call(error: click.ClickException) -> str:
    """Say where to read how a command is called, where something is missing."""
    if isinstance(error, click.MissingParameter) and error.ctx is not None:
        return f" Usage: {' '.join([error.ctx.command_path, *error.ctx.command.collect_usage_pieces(error.ctx)])}"
    return ""


def _show(incomplete: list[str], message: Warning | str, category: type[Warning], *place: Any) -> None:
    """Print our warnings in a line, and remember what an answer lacks; print those of others as Python does."""
    if issubclass(category, DamageWarning):
        incomplete.append(str(message))
    if issubclass(category, (DamageWarning, StaleWarning)):
        click.echo(f"vines: {message}", err=True)
    else:
        click.echo(warnings.formatwarning(message, category, *place[:2]), err=True, nl=False)


def _named(error: OSError) -> str:
    """Say which variable named the folder that an error is about, if one did."""
    for variable in ("VINES_DATA", "VINES_ROOT"):
        folder = os.environ.get(variable)
        if folder and error.filename and Path(os.fsdecode(error.filename)).is_relative_to(Path(folder).absolute()):
            return f"; {variable} names the folder {folder}"
    return ""
