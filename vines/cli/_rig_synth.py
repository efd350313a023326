"""``vines rig synth``: a run folder of a synthetic rig."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import click

from vines.errors import ParameterError, nearest


@click.command("synth")
@click.argument("folder", type=click.Path(path_type=Path))
@click.option("--seed", type=click.IntRange(min=0), default=0, show_default=True, help="Of everything that is drawn.")
@click.option("--draw", is_flag=True, help="Draw the imperfections over their ranges; else the rig is a good one.")
@click.option("--set", "given", multiple=True, metavar="K=V", help="A setting, e.g. E=2.5e-4, form=uff, fault=sign.")
def command(folder: Path, seed: int, draw: bool, given: tuple[str, ...]) -> None:
    """Make the run folder FOLDER of a synthetic rig; its truth goes to sealed/ beside it.

    \b
    vines rig synth demo/run_1 --seed 1 --draw
    vines rig synth demo/run_2 --set E=3e-4 --set form=hdf5 --set duration=20
    """  # noqa: D301
    import msgspec

    from vines.rig.synth import RigSettings, draw_settings, make_run

    form = {"run_id": folder.name, **read_settings(given)}
    try:
        settings = msgspec.convert(form, RigSettings)
    except msgspec.ValidationError as unfit:
        raise ParameterError(f"--set: {unfit}") from None
    if draw:
        settings = draw_settings(seed, **{name: getattr(settings, name) for name in form})
    run = make_run(folder, settings, seed)
    pattern = (run.truth["pattern"] or {}).get("name", "free decay")
    count = len(run.truth["impacts"]["t"])
    files = ", ".join(f"raw/{name}" for name in run.files)
    click.echo(f"wrote {folder} ({files}): {settings.duration:g} s at {settings.rate:g} Hz, {count} impacts, {pattern}")
    click.echo(
        f"its truth is sealed in {folder.parent / 'sealed' / (folder.name + '.json')}; nothing of vines reads it"
    )


def read_settings(texts: tuple[str, ...]) -> dict[str, Any]:
    """Return settings given as key=value, values as JSON or as a plain word."""
    import msgspec

    from vines.rig.synth import RigSettings

    known = [field.name for field in msgspec.structs.fields(RigSettings)]
    found: dict[str, Any] = {}
    for text in texts:
        key, sign, value = text.partition("=")
        if not sign:
            raise ParameterError(f"--set {text!r} is not of the form key=value, such as E=2.5e-4")
        if key not in known:
            raise ParameterError(f"--set {text!r}: no setting {key!r}: {nearest(key, known)}")
        try:
            found[key] = json.loads(value)
        except json.JSONDecodeError:
            found[key] = value
    return found
