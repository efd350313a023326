"""``vines run NAME``: compute what a pipeline still lacks."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import click

from vines.cli._study import the_study
from vines.errors import DeclarationError, RunFailed

if TYPE_CHECKING:
    from vines.pipeline import Event, StagePlan


@click.command("run")
@click.argument("name", metavar="NAME|FILE")
@click.argument("stages", nargs=-1, metavar="[STAGE]...")
@click.option(
    "--set", "settings", multiple=True, metavar="K=V", help="Replace a value, e.g. stages.up.vary.A.count=801."
)
@click.option("--jobs", type=click.IntRange(min=1), help="Processes; all cores if left out, one where more do not pay.")
@click.option("--engine", type=click.Choice(["local", "dask"]), default="local", help="Who computes the points.")
@click.option(
    "--scheduler",
    metavar="ADDR",
    help="A dask scheduler, e.g. tcp://node1:8786; else dask starts a cluster of its own here.",
)
@click.option("--shard", metavar="I/N", help="Compute one of N shares of the points; 'vines merge' puts all together.")
@click.option("--dry-run", is_flag=True, help="Say what would be computed, why, and how long it takes; keep nothing.")
@click.option("--force", is_flag=True, help="Compute everything again.")
@click.option("--retry-failed", is_flag=True, help="Try the points again that failed.")
@click.option("--watch", is_flag=True, help="Show each motion in the Rerun viewer as soon as it is computed.")
@click.option("--web", is_flag=True, help="With --watch: on a page on 127.0.0.1.")
@click.option(
    "--save", type=click.Path(dir_okay=False, path_type=Path), help="With --watch: write recordings (.rrd) instead."
)
@click.option("--quiet", is_flag=True, help="Show no progress.")
@click.option("--json", "as_json", is_flag=True, help="For machines: where each stage stands in the end, no progress.")
def command(
    name: str,
    stages: tuple[str, ...],
    settings: tuple[str, ...],
    jobs: int | None,
    engine: Literal["local", "dask"],
    scheduler: str | None,
    shard: str | None,
    dry_run: bool,
    force: bool,
    retry_failed: bool,
    watch: bool,
    web: bool,
    save: Path | None,
    quiet: bool,
    as_json: bool,
) -> None:
    """Compute what the pipeline NAME (or declared in FILE) still lacks; all of it, or the named stages.

    A collection such as "paper" runs its pipelines one after the other, and goes on when one fails; a STAGE is then a
    pipeline or <pipeline>.<stage>, and the name of the pipeline stands first in --set.

    What is computed is kept by point: a second run computes nothing, a finer grid only what is new, and after an
    interruption the same command goes on.

    \b
    vines run quickstart
    vines run quickstart --dry-run                     say what would be computed
    vines run ball.toml --set params.r=0.6             another value, once
    vines run quickstart --watch                       see each motion as soon as it is there
    """  # noqa: D301
    from vines.cli._watched import how_to_watch, watched
    from vines.stages import compile_if_cold, estimate, run, status

    if scheduler is not None and engine != "dask":
        raise DeclarationError(f"--scheduler {scheduler} needs --engine dask")
    if engine == "dask":
        from vines.packages import need
        from vines.pipeline import check_address

        need("distributed")
        if scheduler is not None:
            check_address(scheduler)
    if shard is not None:
        from vines.pipeline import Shard

        Shard.read(shard)
    if shard is not None and force:
        raise DeclarationError("--shard cannot be forced: shards see what others computed; force without --shard")

    shown = how_to_watch(watch=watch, web=web, save=save, idle="--dry-run" if dry_run else "")
    overrides = dict(read_setting(text) for text in settings)
    chosen = stages or None
    study = the_study()
    plans = status(name, stages=chosen, overrides=overrides, study=study)
    quiet = quiet or as_json
    if dry_run:
        compile_if_cold(plans, (lambda line: None) if quiet else click.echo)
        told = {"overrides": overrides, "jobs": jobs, "force": force, "retry_failed": retry_failed, "study": study}
        seconds = estimate(name, stages=chosen, **told)
        counts = [_would_compute(p, force=force, retry_failed=retry_failed) for p in plans]
        if as_json:
            also = [{"would_compute": n, "seconds": seconds.get(p.name)} for n, p in zip(counts, plans, strict=True)]
            _print_json(name, plans, also)
        else:
            _print_plans(plans, counts, seconds, force=force)
        return
    if not force and not retry_failed and all(p.state == "up_to_date" for p in plans):
        if not quiet:
            failed = sum(p.failed for p in plans)
            tail = f"; {failed} points failed before (--retry-failed tries them again)" if failed else ""
            click.echo(f"{name}: nothing to compute, all {len(plans)} stages are up to date{tail}")
            if watch:
                click.echo("nothing to watch: 'vines view' shows what is there, --force computes it again")
            _say_what_was_found(name)
        if as_json:
            _print_json(name, plans)
        if any(p.failed for p in plans):
            raise click.exceptions.Exit(RunFailed.exit_code)
        return
    from vines.cli._progress import progress

    compile_if_cold(plans, (lambda line: None) if quiet else click.echo)
    failure: RunFailed | None = None

    def say(line: str) -> None:
        click.echo(line, err=quiet)

    with watched(shown, save, say) as watching:
        with progress(quiet) as report:

            def both(event: Event) -> None:
                report(event)
                if watching is not None:
                    watching(event)

            try:
                run(
                    name,
                    stages=chosen,
                    overrides=overrides,
                    jobs=jobs,
                    engine=engine,
                    scheduler=scheduler,
                    shard=shard,
                    force=force,
                    retry_failed=retry_failed,
                    report=both,
                    study=study,
                )
            except RunFailed as error:
                failure = error
        if as_json:
            _print_json(name, status(name, stages=chosen, overrides=overrides, study=study))
        elif shard is not None and not quiet:
            click.echo(f"shard {shard} is computed; when all are, 'vines merge {name}' puts the results together")
        elif not quiet:
            _say_what_was_found(name)
        if watching is not None:
            watching.stay(wait=shown != "save")
    if failure is not None:
        raise failure


def read_setting(text: str) -> tuple[str, str]:
    key, sign, value = text.partition("=")
    if not sign or not key.strip():
        raise DeclarationError(f"--set {text!r} is not of the form key=value, such as stages.up.vary.A.count=801")
    return key.strip(), value.strip()


def _would_compute(plan: StagePlan, *, force: bool, retry_failed: bool) -> int:
    return plan.wanted if force else plan.wanted - plan.done + (plan.failed if retry_failed else 0)


def _print_json(name: str, plans: list[StagePlan], also: Sequence[dict[str, object]] = ()) -> None:
    """Print where each stage stands, in the words of ``vines status --json``, and what else is known of it."""
    stages = [asdict(plan) | more for plan, more in zip(plans, also or [{}] * len(plans), strict=True)]
    click.echo(json.dumps({name: stages}, indent=2))


def _print_plans(plans: list[StagePlan], counts: list[int], seconds: dict[str, float], *, force: bool) -> None:
    from vines.cli._layout import print_rows
    from vines.cli._progress import duration

    rows = []
    for p, count in zip(plans, counts, strict=True):
        why = "forced" if force else p.reason or ("failed before" if count else "up to date")
        takes = duration(seconds[p.name]) if p.name in seconds else ""
        rows.append([p.name, p.kind, f"{count} of {p.wanted}", takes, why])
    print_rows(["stage", "kind", "would compute", "takes about", "why"], rows, wrap=4)


def _say_what_was_found(name: str) -> None:
    from vines.stages import found

    lines = found(name, study=the_study())
    if lines:
        click.echo("\n" + "\n".join(lines))
