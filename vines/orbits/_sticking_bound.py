"""The end of a family of orbits that stick, followed in a second parameter: the bound of where they are."""

from __future__ import annotations

from collections.abc import Sequence

from vines.domains import Name, Number, Numbers, Of, stated
from vines.errors import OrbitNotFound, ParameterError
from vines.orbits._branch import Bifurcation
from vines.orbits._continuation import continue_orbit
from vines.orbits._orbit import Orbit

__all__ = ["follow_end"]


@stated(
    ParameterError,
    orbit=Of("Orbit", how="as vines.find_orbit returns it"),
    parameter=Name(),
    stop=Number(),
    other=Name(),
    values=Numbers(),
)
def follow_end(orbit: Orbit, parameter: str, stop: float, *, other: str, values: Sequence[float]) -> list[Bifurcation]:
    """Return where the family of an orbit that sticks ends in one parameter, at each value of another one.

    From one value to the next the orbit is followed in the other parameter, and at each of them in the first one to its
    end, which is as exact as there (1e-9 of the range or so). Where the curve turns back in the other parameter,
    exchange the two.

    Parameters
    ----------
    orbit : Orbit
        One with a star, well inside the family.
    parameter : str
        The parameter in which the family ends.
    stop : float
        Its value up to which the family is followed.
    other : str
        The second parameter.
    values : sequence of float
        Its values, in the order in which to go.

    Returns
    -------
    list of Bifurcation
        The end at each value, `params` having both parameters; values at which the family reaches `stop` are left out,
        and so is what comes after a value to which the orbit cannot be followed.

    Raises
    ------
    ParameterError
        If the orbit does not stick, or the two parameters are one.

    Examples
    --------
    >>> from vines.model import Params
    >>> from vines.orbits import find_orbit
    >>> orbit = find_orbit("L*R*", Params(mu=0.01, A=0.5))
    >>> for end in follow_end(orbit, "A", 0.05, other="mu", values=[0.01, 0.02]):
    ...     print(end.type, f"mu = {end.params.mu:g}, A = {end.params.A:.5f}")
    incomplete_chatter mu = 0.01, A = 0.22619
    incomplete_chatter mu = 0.02, A = 0.33894
    """
    if not orbit.word.sticking:
        raise ParameterError(f"the orbit {orbit.word} does not stick; follow its bifurcations with follow_curve")
    for name in (parameter, other):
        orbit.params.system.parameter(name)
    if parameter == other:
        raise ParameterError(f"parameter and other are both {other}; give two")
    found: list[Bifurcation] = []
    for value in values:
        if getattr(orbit.params, other) != value:
            try:
                way = continue_orbit(orbit, other, value)
            except OrbitNotFound:
                break
            orbit = way.orbits[-1]
            if getattr(orbit.params, other) != value:
                break
        branch = continue_orbit(orbit, parameter, stop)
        if branch.ends[1] not in ("range", "lost", "points"):
            found.append(branch.bifurcations[-1])
    return found
