"""``vines run NAME``: compute what a pipeline still lacks."""

from __future__ import annotations

from typing import Any

import click

from vines.errors import DeclarationError, RunFailed


@click.command("run")
@click.argument("name", metavar="NAME|FILE")
@click.argument("stages", nargs=-1, metavar="[STAGE]...")
@click.option(
    "--set", "settings", multiple=True, metavar="K=V", help="Replace a value, e.g. stages.up.vary.A.count=801."
)
@click.option("--jobs", type=click.IntRange(min=1), help="Processes; all cores if left out, one where more do not pay.")
@click.option("--dry-run", is_flag=True, help="Say what would be computed, and why; compute nothing.")
@click.option("--force", is_flag=True, help="Compute everything again.")
@click.option("--retry-failed", is_flag=True, help="Try the points again that failed.")
@click.option("--quiet", is_flag=True, help="Show no progress.")
def command(
    name: str,
    stages: tuple[str, ...],
    settings: tuple[str, ...],
    jobs: int | None,
    dry_run: bool,
    force: bool,
    retry_failed: bool,
    quiet: bool,
) -> None:
    """Compute what the pipeline NAME (or declared in FILE) still lacks; all of it, or the named stages.

    What is computed is kept by point: a second run computes nothing, a finer grid only what is new, and after an
    interruption the same command goes on.
    """
    from vines.stages import compile_if_cold, run, status

    overrides = dict(_setting(text) for text in settings)
    chosen = stages or None
    plans = status(name, stages=chosen, overrides=overrides)
    if dry_run:
        _print_plans(plans)
        return
    if not force and not retry_failed and all(p.state == "up_to_date" for p in plans):
        if not quiet:
            failed = sum(p.failed for p in plans)
            tail = f"; {failed} points failed before (--retry-failed tries them again)" if failed else ""
            click.echo(f"{name}: nothing to compute, all {len(plans)} stages are up to date{tail}")
            _say_what_was_found(name)
        return
    from vines.cli._progress import progress

    compile_if_cold(plans, (lambda line: None) if quiet else click.echo)
    failure: RunFailed | None = None
    with progress(quiet) as report:
        try:
            run(
                name,
                stages=chosen,
                overrides=overrides,
                jobs=jobs,
                force=force,
                retry_failed=retry_failed,
                report=report,
            )
        except RunFailed as error:
            failure = error
        except KeyboardInterrupt:
            raise click.ClickException(f"stopped; what is finished is kept, 'vines run {name}' goes on") from None
    if not quiet:
        _say_what_was_found(name)
    if failure is not None:
        raise failure


def _setting(text: str) -> tuple[str, str]:
    key, sign, value = text.partition("=")
    if not sign or not key.strip():
        raise DeclarationError(f"--set {text!r} is not of the form key=value, such as stages.up.vary.A.count=801")
    return key.strip(), value.strip()


def _print_plans(plans: Any) -> None:
    from vines.cli._layout import print_rows

    print_rows(
        ["stage", "kind", "would compute", "why"],
        [[p.name, p.kind, f"{p.wanted - p.done} of {p.wanted}", p.reason or "up to date"] for p in plans],
        wrap=3,
    )


def _say_what_was_found(name: str) -> None:
    from vines.stages import found

    lines = found(name)
    if lines:
        click.echo("\n" + "\n".join(lines))
