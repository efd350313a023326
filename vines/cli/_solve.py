"""``vines solve``: one periodic orbit, or all of a word, for a person or a machine to read."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
import msgspec

from vines import systems
from vines.cli._parameters import OfSystem
from vines.model import STATE_NAMES, VI_NES, Word, system_names

if TYPE_CHECKING:
    from vines.orbits import Orbit


@click.command("solve", cls=OfSystem)
@click.argument("word")
@click.option(
    "--system",
    type=click.Choice(system_names()),
    default=VI_NES.name,
    show_default=True,
    help="The system; options are those of its parameters: --system NAME --help lists them.",
)
@click.option("--all", "every", is_flag=True, help="All orbits of the word that are found, not only one.")
@click.option(
    "--log",
    type=click.Path(dir_okay=False, path_type=Path),
    help="Write one period as an MCAP log too; 'vines view' shows it going round.",
)
@click.option("--json", "as_json", is_flag=True, help="For machines.")
def command(
    word: str,
    system: str,
    every: bool,
    log: Path | None,
    as_json: bool,
    **parameters: float,
) -> None:
    """Print the periodic orbit of a WORD of impacts, such as LR, LLR or LRLR/2T.

    Without impacts a WORD is - or 0:0, for two forcing periods -/2T or 0:0/2T. A star stands behind a chatter that
    ends in sticking, such as L*R*, which a shell wants in quotes; a word without a star is that of orbits that never
    stick. Of several the symmetric admissible one is shown, else a stable one,
    else the one with the smallest largest multiplier. Exit 1 if there is none.

    \b
    vines solve LR --mu 0.01 --A 0.017
    vines solve LLR --mu 0.01 --A 0.023 --all
    vines solve 'L*R*' --mu 0.01 --A 0.5
    vines solve LR --mu 0.01 --A 0.02 --log orbit.mcap && vines view orbit.mcap
    vines solve LLR --system impact_pair --B 0.95 --G 0.15 --r 0.5
    vines solve - --system cubic_barriers --mu 0.05 --A 0.05 --k3 3 --l2 0.2 --walls 0
    vines solve L1L2R1R2 --system parallel --A 0.03 --mu_1 0.01 --mu_2 0.01 --beta_2 1.4
    """  # noqa: D301
    if every and log is not None:
        raise click.UsageError("--log writes one orbit; leave out --all")
    p = systems.parameters(system).of(parameters)
    Word(word)
    # once all is checked: it loads the compiler
    from vines.orbits import all_orbits, find_orbit, orbit_outline, orbit_row

    row = orbit_row if system == VI_NES.name else orbit_outline

    if every:
        found = all_orbits(word, p)
        # With no orbit the search for one says why and how near it came.
        orbits = list(found) or [find_orbit(word, p)]
        complete, remark = found.complete, found.remark
    else:
        orbits, complete, remark = [find_orbit(word, p)], None, None
    if log is not None:
        from vines.stages import orbit_log

        orbit_log(orbits[0], log)
    if as_json:
        rows = [{**row(orbit), "remark": orbit.remark} for orbit in orbits]
        shown: Any = {"complete": complete, "remark": remark, "orbits": rows} if every else rows[0]
        click.echo(msgspec.json.format(msgspec.json.encode(shown, enc_hook=float), indent=1))
        return
    if every:
        count = f"{len(orbits)} orbit{'s' if len(orbits) > 1 else ''}"
        click.echo(f"{count} of this word{', and no more' if complete else ''} ({remark})\n")
    click.echo("\n\n".join(describe(orbit) for orbit in orbits))


def describe(orbit: Orbit) -> str:
    """Return an orbit as lines that a person wants to read.

    Examples
    --------
    >>> from vines.model import Params
    >>> from vines.orbits import find_orbit
    >>> print(describe(find_orbit("LR", Params(mu=0.01, A=0.017))).splitlines()[0])
    1:1 (LR): symmetric, stable, admissible
    """
    from vines.cli._layout import lines
    from vines.dynamics import ball_locked, no_ball
    from vines.dynamics.kernels import room_of

    p, m = orbit.params, orbit.measures
    label = orbit.name if orbit.alias == orbit.name else f"{orbit.name}, in the paper {orbit.alias}"
    kinds = [
        "symmetric" if orbit.symmetric else "asymmetric",
        "stable" if orbit.stable else "unstable",
        "admissible" if orbit.admissible else "not admissible",
    ]
    text = [f"{label} ({orbit.word}): {', '.join(kinds)}", f"at {p}, period {orbit.period:.10g}"]
    if not orbit.admissible:
        side = VI_NES.letters([orbit.violation_side])
        text.append(
            f"between its impacts it would meet {side} at t = {orbit.violation_time:.10g}: no orbit of the model"
        )
    if orbit.remark:
        text.append(orbit.remark)
    strikes = not orbit.word.unstruck
    letters = [
        p.system.letters([side], [ball]) if strikes else ""
        for side, ball in zip(orbit.side, orbit.word.balls, strict=True)
    ]
    states = orbit.states.tolist()
    rows = [
        [letter, *(f"{value:.10f}" for value in (t, phase, wait, *state, w_dot))]
        for letter, t, phase, wait, state, w_dot in zip(
            letters, orbit.t, orbit.phase, orbit.flight_times, states, orbit.w_dot, strict=True
        )
    ]
    head = ["", "t", "phase", "to the next", *STATE_NAMES, *room_of(p).beside, "w'"]
    what = "impacts (just before each)" if strikes else "at phase 0 of the forcing (nothing is hit)"
    text += ["", what, *lines(head, rows, wrap=None)]
    if len(orbit.spells):
        names = ("t_start", "t_release", "phase_start", "phase_release", "x1", "v1")
        spells = [
            [letters[spell["contact"]], *(f"{spell[name]:.10f}" for name in names), str(spell["impacts"])]
            for spell in orbit.spells
        ]
        head = ["", "chatter ends", "release", "its phase", "its phase", "x1 there", "v1 there", "impacts followed"]
        text += ["", "sticking (after a chatter, of which the first impact stands above)"]
        text += lines(head, spells, wrap=None)
    text += ["", "Floquet multipliers over the period"]
    text += lines(["", "modulus"], [[_complex(z), f"{abs(z):.10f}"] for z in orbit.multipliers.tolist()], wrap=None)
    clearance = (
        "no barriers"
        if math.isnan(orbit.min_clearance)
        else "no flight turns back"
        if orbit.min_clearance == 2
        else f"{orbit.min_clearance:.6g}"
    )
    measures: list[list[object]] = []
    if "max_abs_x1" not in p.system.without:
        free, locked = no_ball(p), ball_locked(p)
        measures = [
            ["K2/K1", f"{m.kinetic_ratio:.10g}", ""],
            ["max|x1|", f"{m.max_abs_x1:.10g}", f"{m.max_abs_x1 / free:.4g} of that without ball, {free:.6g}"],
            ["", "", f"{m.max_abs_x1 / locked:.4g} of that with the ball locked, {locked:.6g}"],
            ["rms x1", f"{m.rms_x1:.10g}", ""],
        ]
    measures.append(
        ["least clearance", clearance, "" if orbit.min_clearance == 2 else "of a turning point from its wall"]
    )
    text += ["", "measures", *(line for line in lines(["", "", ""], measures, wrap=None) if line)]
    energies: list[list[object]] = [
        ["base work", f"{m.base_work:.10g}"],
        ["lost in the damper", f"{m.damper_loss:.10g}"],
        ["lost in impacts on L", f"{m.impact_loss_left:.10g}"],
        ["lost in impacts on R", f"{m.impact_loss_right:.10g}"],
        ["left over, relative", f"{orbit.energy_imbalance:.1e}"],
    ]
    if m.travel_loss:
        energies.insert(-1, ["lost by the ball on its way", f"{m.travel_loss:.10g}"])
    text += ["", f"energy over the period, in {'m b² omega²' if isinstance(p, systems.ImpactPair) else 'M b² omega0²'}"]
    text += [line for line in lines(["", ""], energies, wrap=None) if line]
    text += ["", f"residual {orbit.residual:.1e}"]
    return "\n".join(text)


def _complex(z: complex) -> str:
    return f"{z.real:+.10f}" + (f" {z.imag:+.10f}i" if z.imag else "")
