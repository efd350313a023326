"""What `vines.rig` says of runs of the second rig: verdicts, causes named, and how far r is off."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

from benchmarks.rig_runs import true_values
from benchmarks.second_rig._record import record
from benchmarks.second_rig._settings import HARMLESS, PHYSICS, draw_rig, rest_of
from vines.errors import VinesError
from vines.rig import compare, reconstruct, ring_down
from vines.rig.synth import read_raw


@dataclass(frozen=True)
class Scored:
    """A run of the second rig and what was said of it.

    Attributes
    ----------
    seed, physics : int, str
    strength : str
        Of the effect, in words.
    verdict, reason : str
        ``refused`` where it was not read.
    named : bool
        Whether a word of `PHYSICS` is in the reason or, where the run is the model's, in what was found.
    ratios : dict
        (estimate - truth)/u by quantity.
    stated : bool
        Whether friction was stated.
    friction : float
        The true one [m/s^2].
    """

    seed: int
    physics: str
    strength: str
    verdict: str = "refused"
    reason: str = ""
    named: bool = False
    ratios: dict[str, float] = field(default_factory=dict)
    stated: bool = True
    friction: float = 0.0

    @property
    def wrong(self) -> bool:
        """Whether it agrees where the model does not hold."""
        return self.verdict == "agree" and self.physics not in HARMLESS


def score(
    seed: int, physics: str, strength: float = 1.0, duration: float = 40.0, stated: bool | None = None,
    verdict: bool = True,
) -> Scored:  # fmt: skip
    """Make, read, reconstruct and compare a run of the second rig."""
    os.environ.setdefault("NUMBA_NUM_THREADS", "1")
    rig = draw_rig(seed, physics, strength=strength, duration=duration)
    if stated is not None:
        rig = replace(rig, friction_stated=stated)
    raw = record(rig)
    plain = draw_rig(seed, "none", duration=duration)
    changed = [name for name in rig.__dataclass_fields__ if getattr(rig, name) != getattr(plain, name)]
    text = ", ".join(f"{name}={getattr(rig, name):.3g}" for name in changed if isinstance(getattr(rig, name), float))
    own = Scored(seed, physics, text, stated=rig.friction_stated, friction=rig.friction)
    words = PHYSICS[physics]
    try:
        free = [ring_down(read_raw(record(rest_of(rig, k)))) for k in range(2)]
        found = reconstruct(read_raw(raw), free)
    except VinesError as error:
        return replace(own, reason=str(error), named=any(word in str(error) for word in words))
    told = compare(found) if verdict else None
    reason = told.reason if told is not None else found.reasons
    said = " ".join([reason, *(one.text for one in found.findings if physics in HARMLESS or not one.passed)])
    true = true_values(raw.truth)
    q = found.quantities
    ratios = {name: (q[name].value - value) / q[name].u for name, value in true.items() if name in q and q[name].u > 0}
    return replace(
        own, verdict=told.verdict if told is not None else ("accepted" if found.accepted else "not accepted"),
        reason=reason, named=any(word in said for word in words), ratios=ratios,
    )  # fmt: skip


def show(runs: Sequence[Scored]) -> None:
    """Print verdicts and causes by effect, and every run that agrees where the model does not hold."""
    print(f"{'physics':14} {'runs':>4}  {'named':>8}  {'wrong':>5}  verdicts")
    for physics in PHYSICS:
        own = [one for one in runs if one.physics == physics]
        if not own:
            continue
        verdicts = {v: sum(one.verdict == v for one in own) for v in sorted({one.verdict for one in own})}
        named = "-" if physics == "none" else f"{sum(one.named for one in own)} of {len(own)}"
        wrong = sum(one.wrong for one in own)
        print(
            f"{physics:14} {len(own):>4}  {named:>8}  {wrong:>5}  " + ", ".join(f"{v} {n}" for v, n in verdicts.items())
        )
    told = [one for one in runs if one.physics != "none"]
    if told:
        share = sum(one.named for one in told) / len(told)
        print(f"cause named in {share:.0%} of {len(told)} runs; {sum(one.wrong for one in runs)} agree wrongly")
    for one in runs:
        if (
            one.wrong
            or (one.physics != "none" and not one.named)
            or (one.physics in HARMLESS and one.verdict != "agree")
        ):
            print(f"  {one.seed} {one.physics} ({one.strength}): {one.verdict}: {one.reason[:200]}")
