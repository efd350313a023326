"""Systems as ``schemas/systems/*.toml`` declares them."""

from __future__ import annotations

import functools
import math
import re
import tomllib
from collections.abc import Iterable, Mapping
from typing import Any

from vines.errors import SchemaError, UnknownNameError, nearest
from vines.model._system import Body, Contact, Coordinate, Energies, Parameter, Range, Symmetry, System
from vines.places import shipped

__all__ = ["most_balls", "read_system", "system_names", "with_all_balls", "with_one_ball"]


@functools.cache
def read_system(name: str, balls: int = 0, digest: str = "") -> System:
    """Return a system as its file declares it.

    Parameters
    ----------
    name : str
        Name of the system, and of its file.
    balls : int
        How many balls it has, where its file leaves that open; what is there once a ball gets the ball's number.
    digest : str
        What :attr:`System.digest` has to be. Code that relies on a declaration names it, so that the digest of the code
        is also one of the declaration.

    Raises
    ------
    UnknownNameError
        If there is no such system; the message names the nearest.
    SchemaError
        If the file cannot be read, the system cannot have so many balls, or the declaration is another one.

    Examples
    --------
    >>> [each.name for each in read_system("impact_pair").parameters]
    ['B', 'G', 'r']
    >>> pair_of_balls = read_system("parallel", 2)
    >>> pair_of_balls.state[-1].name, [each.letter for each in pair_of_balls.contacts]
    ('v2_2', ['L1', 'L2', 'R1', 'R2'])
    """
    form, most, file = _form(name), most_balls(name), f"schemas/systems/{name}.toml"
    if not (1 <= balls <= most if most else balls == 0):
        allowed = f"1 to {most} balls" if most else "one ball, which has no number"
        raise SchemaError(f"the system {name!r} has {allowed}, not {balls}")
    try:
        found = _system(form, balls)
    except (AttributeError, KeyError, TypeError, ValueError) as error:
        raise SchemaError(f"{file}: {error}; correct it, or install vines again") from None
    if digest and found.digest != digest:
        raise SchemaError(
            f"{file} has the digest {found.digest}, the code was written for {digest}; write the new one into the code "
            "if the change is meant, or install vines again"
        )
    return found


@functools.cache
def system_names() -> tuple[str, ...]:
    """Return the names of all systems.

    Examples
    --------
    >>> system_names()
    ('cubic_barriers', 'drag', 'friction', 'hybrid', 'impact_pair', 'parallel', 'vi_nes')
    """
    return tuple(sorted(path.stem for path in (shipped("schemas") / "systems").glob("*.toml")))


def most_balls(name: str) -> int:
    """Return how many balls a system may have at most; 0 where it has one without a number.

    Raises
    ------
    UnknownNameError
        If there is no such system; the message names the nearest.

    Examples
    --------
    >>> most_balls("parallel"), most_balls("impact_pair")
    (8, 0)
    """
    return _form(name).get("balls", 0)


def with_one_ball(name: str) -> System:
    """Return a system with one ball, with a number where balls have numbers.

    Examples
    --------
    >>> with_one_ball("parallel").balls, with_one_ball("impact_pair").balls
    (1, 0)
    """
    return read_system(name, min(most_balls(name), 1))


def with_all_balls(name: str) -> System:
    """Return a system with as many balls as it may have: all its names.

    Examples
    --------
    >>> with_all_balls("parallel").balls, with_all_balls("impact_pair").balls
    (8, 0)
    """
    return read_system(name, most_balls(name))


@functools.cache
def _form(name: str) -> dict[str, Any]:
    if name not in system_names():
        raise UnknownNameError(f"unknown system {name!r}: {nearest(name, system_names())}")
    return tomllib.loads((shipped("schemas") / "systems" / f"{name}.toml").read_text("utf-8"))


def _system(form: Mapping[str, Any], balls: int) -> System:
    own = {each["name"] for key in ("rig", "run") for each in form.get(key, ()) if "each" in each}
    mirror, energies = form["mirror"], form["energies"]
    numbers = [str(ball) for ball in range(1, balls + 1)] or [""]
    return System(
        name=form["name"],
        title=form["title"],
        parameters_of=form["parameters_of"],
        balls=balls,
        parameters=tuple(_parameter(each, n, own) for each, n in _numbered(form["parameters"], balls)),
        rig=tuple(_parameter(each, n, own) for each, n in _numbered(form.get("rig", ()), balls)),
        run=tuple(_parameter(each, n, own) for each, n in _numbered(form.get("run", ()), balls)),
        bodies=tuple(_body(each, n) for each, n in _numbered(form["bodies"], balls)),
        phase=_coordinate(form["phase"], 0),
        contacts=tuple(_contact(each, n) for each, n in _numbered(form["contacts"], balls)),
        mirror=Symmetry(
            sign=mirror["sign"],
            shift=mirror["shift"],
            letters={old + n: new + n for old, new in mirror["letters"].items() for n in numbers},
            broken_by=tuple(mirror.get("broken_by", ())),
        ),
        energies=Energies(**{key: tuple(names) for key, names in energies.items()}),
        met=tuple(_coordinate(each[key], 0) for each in form["bodies"] for key in ("position", "velocity")),
        without=tuple(form.get("without", ())),
        order=form.get("order", 0),
        stops=form.get("stops", False),
        starred=form.get("starred", True),
        smooth=form.get("smooth", False),
    )


def _numbered(forms: Iterable[Mapping[str, Any]], balls: int) -> list[tuple[dict[str, Any], int]]:
    """Return each entry with the number of its ball, those of a ball once for each; 0 for what belongs to none."""
    return [
        ({key: value for key, value in form.items() if key != "each"}, number)
        for form in forms
        for number in (range(1, balls + 1) if "each" in form else (0,))
    ]


def _parameter(form: dict[str, Any], ball: int, own: Iterable[str]) -> Parameter:
    if ball:
        form = form | _of_ball(form, ball)
        for name in own:
            form["physical"] = re.sub(rf"\b{name}\b", f"{name}_{ball}", form.get("physical", ""))
    return Parameter(**_ranged(form))


def _coordinate(form: dict[str, Any], ball: int) -> Coordinate:
    return Coordinate(**_ranged(form | (_of_ball(form, ball) if ball else {})))


def _ranged(form: Mapping[str, Any]) -> dict[str, Any]:
    """Return an entry with its range: ``least`` and ``most`` belong to it, ``above`` and ``below`` do not.

    Examples
    --------
    >>> _ranged({"allowed": {"above": 0}})["allowed"].of("mu")
    'mu > 0'
    """
    ends = form.get("allowed", {})
    allowed = Range(
        least=ends.get("above", ends.get("least", -math.inf)),
        most=ends.get("below", ends.get("most", math.inf)),
        above="above" in ends,
        below="below" in ends,
    )
    return {**form, "allowed": allowed}


def _body(form: dict[str, Any], ball: int) -> Body:
    name = f"{form['name']}_{ball}" if ball else form["name"]
    return Body(name, _coordinate(form["position"], ball), _coordinate(form["velocity"], ball))


def _contact(form: dict[str, Any], ball: int) -> Contact:
    if not ball:
        return Contact(**form)
    return Contact(f"{form['letter']}{ball}", form["sign"], f"{form['text']}, ball {ball}", ball)


def _of_ball(form: Mapping[str, Any], ball: int) -> dict[str, Any]:
    found = {"name": f"{form['name']}_{ball}", "text": f"{form['text']}, ball {ball}"}
    if "symbol" in form:
        found["symbol"] = _subscript(form["symbol"], ball)
    if "label" in form:
        found["label"] = f"{form['label']} {ball}"
    return found


def _subscript(symbol: str, ball: int) -> str:
    """Return a symbol with the number of a ball.

    Examples
    --------
    >>> _subscript("r", 1), _subscript("x_2", 3), _subscript("x_2'", 3)
    ('r_{1}', 'x_{2,3}', "x_{2,3}'")
    """
    stem, prime = symbol.rstrip("'"), "'" * (len(symbol) - len(symbol.rstrip("'")))
    base, _, index = stem.partition("_")
    return f"{base}_{{{','.join(filter(None, (index, str(ball))))}}}{prime}"
