"""``vines warm-up``: compile the kernels visibly."""

from __future__ import annotations

import click


@click.command("warm-up")
def command() -> None:
    """Compile the kernels now, so that the first run does not wait for it.

    Compiled kernels are kept under data/cache, named by the digest of their sources; a second call is quick.
    """
    from vines.stages import warm_up

    warm_up(click.echo)
