"""``vines rig inspect``: what a raw file holds."""

from __future__ import annotations

from pathlib import Path

import click
import msgspec


@click.command("inspect")
@click.argument("file", type=click.Path(path_type=Path))
@click.option("--png", type=click.Path(dir_okay=False, path_type=Path), help="Draw the channels to a picture.")
@click.option(
    "--dialect", default="", help="Layout of a text as far as it is known, e.g. 'separator=tab time_unit=ms'."
)
@click.option("--json", "as_json", is_flag=True, help="For machines.")
def command(file: Path, png: Path | None, dialect: str, as_json: bool) -> None:
    """Show what FILE holds: channels, units, rates, gaps, clipping.

    Of a text it says how it was read; what it finds wrongly can be stated: here to try it, in channels.tsv to keep it.
    'vines rig formats' lists what can be read.
    """
    from vines.rig import channel_facts, draw_file, spark
    from vines.rig.formats import read_file

    found = read_file(file, dialect)
    facts = [channel_facts(each) for each in found.channels]
    if png is not None:
        draw_file(found, file.name).savefig(png, dpi=150)
    if as_json:
        said = {"form": found.form, "started": found.started, "channels": facts, "other": found.other}
        said |= {"dialect": found.dialect, "remarks": found.remarks}
        click.echo(msgspec.json.format(msgspec.json.encode(said), indent=1))
        return
    from vines.cli._layout import print_rows

    count = f"{len(facts)} channel{'s' if len(facts) > 1 else ''}"
    click.echo(f"{file.name}: {found.form}, {count}" + (f", started {found.started}" if found.started else ""))
    if found.dialect:
        click.echo(f"dialect: {found.dialect}")
    rows = [
        [
            each.name,
            each.unit or "not stated",
            f"{each.rate:.9g}" if each.rate else "not stated",
            str(each.samples),
            f"{each.samples / each.rate:.6g}" if each.rate else "",
            f"{each.least:.4g}",
            f"{each.largest:.4g}",
            f"{each.rms:.4g}",
            str(each.clipped),
            spark(channel, 24),
        ]
        for each, channel in zip(facts, found.channels, strict=True)
    ]
    heads = [
        "channel",
        "unit",
        "rate [Hz]",
        "samples",
        "length [s]",
        "least",
        "largest",
        "rms",
        "clipped",
        "size in time",
    ]
    print_rows(heads, rows)
    for each in facts:
        if each.gaps:
            click.echo(f"{each.name}: {each.gaps}")
    for remark in found.remarks:
        click.secho(remark, fg="yellow")
    if found.other:
        click.echo(f"also in it, no channels: {', '.join(found.other[:8])}{' ...' if len(found.other) > 8 else ''}")
    if png is not None:
        click.echo(f"wrote {png}")
