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

__all__ = ["counted", "most_balls", "read_system", "system_names", "with_all_balls", "with_one_ball"]


@functools.cache
def read_system(name: str, count: int = 0, digest: str = "") -> System:
    """Return a system as its file declares it.

    Parameters
    ----------
    name : str
        Name of the system, and of its file.
    count : int
        How many balls, or modes, it has where its file leaves that open; what is there once a ball gets the ball's
        number.
    digest : str
        What :attr:`System.digest` has to be. Code that relies on a declaration names it, so that the digest of the code
        is also one of the declaration.

    Raises
    ------
    UnknownNameError
        If there is no such system; the message names the nearest.
    SchemaError
        If the file cannot be read, the system cannot have so many of them, or the declaration is another one.

    Examples
    --------
    >>> [each.name for each in read_system("impact_pair").parameters]
    ['B', 'G', 'r']
    >>> pair_of_balls = read_system("parallel", 2)
    >>> pair_of_balls.state[-1].name, [each.letter for each in pair_of_balls.contacts]
    ('v2_2', ['L1', 'L2', 'R1', 'R2'])
    """
    form, file = _form(name), f"schemas/systems/{name}.toml"
    what, most = counted(name)
    if not (1 <= count <= most if most else count == 0):
        allowed = f"1 to {most} {what}s" if most else "one ball, which has no number"
        raise SchemaError(f"the system {name!r} has {allowed}, not {count}")
    try:
        found = _system(form, what, count)
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
    ('cubic_barriers', 'drag', 'duffing', 'friction', 'hybrid', 'impact_pair', 'modes', 'parallel', 'vi_nes')
    """
    return tuple(sorted(path.stem for path in (shipped("schemas") / "systems").glob("*.toml")))


def counted(name: str) -> tuple[str, int]:
    """Return what a system may have several of, ``ball`` or ``mode``, and how many at most; ("", 0) if nothing.

    Raises
    ------
    UnknownNameError
        If there is no such system; the message names the nearest.

    Examples
    --------
    >>> counted("parallel"), counted("modes"), counted("impact_pair")
    (('ball', 8), ('mode', 6), ('', 0))
    """
    form = _form(name)
    return next(((what, form[f"{what}s"]) for what in ("ball", "mode") if f"{what}s" in form), ("", 0))


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
    """Return a system with one ball, with a number where balls have numbers; of modes with one mode.

    Examples
    --------
    >>> with_one_ball("parallel").balls, with_one_ball("impact_pair").balls
    (1, 0)
    """
    return read_system(name, min(counted(name)[1], 1))


def with_all_balls(name: str) -> System:
    """Return a system with as many balls, or modes, as it may have: all its names.

    Examples
    --------
    >>> with_all_balls("parallel").balls, with_all_balls("impact_pair").balls, with_all_balls("modes").modes
    (8, 0, 6)
    """
    return read_system(name, counted(name)[1])


@functools.cache
def _form(name: str) -> dict[str, Any]:
    if name not in system_names():
        raise UnknownNameError(f"unknown system {name!r}: {nearest(name, system_names())}")
    return tomllib.loads((shipped("schemas") / "systems" / f"{name}.toml").read_text("utf-8"))


def _system(form: Mapping[str, Any], what: str, count: int) -> System:
    own = {each["name"] for key in ("rig", "run") for each in form.get(key, ()) if "each" in each}
    mirror, energies = form["mirror"], form["energies"]
    balls = count if what == "ball" else 0
    numbers = [str(ball) for ball in range(1, balls + 1)] or [""]
    return System(
        name=form["name"],
        title=form["title"],
        parameters_of=form["parameters_of"],
        balls=balls,
        parameters=tuple(_parameter(each, n, own) for each, n in _numbered(form["parameters"], count)),
        rig=tuple(_parameter(each, n, own) for each, n in _numbered(form.get("rig", ()), count)),
        run=tuple(_parameter(each, n, own) for each, n in _numbered(form.get("run", ()), count)),
        bodies=tuple(_body(each, n) for each, n in _numbered(form["bodies"], count)),
        phase=_coordinate(form["phase"], "", 0),
        contacts=tuple(_contact(each, n) for each, n in _numbered(form["contacts"], count)),
        mirror=Symmetry(
            sign=mirror["sign"],
            shift=mirror["shift"],
            letters={old + n: new + n for old, new in mirror["letters"].items() for n in numbers},
            broken_by=tuple(mirror.get("broken_by", ())),
        ),
        energies=Energies(**{key: tuple(names) for key, names in energies.items()}),
        met=tuple(
            _coordinate(each[key], "", 0)
            for each in form["bodies"]
            if each.get("each") != "mode"
            for key in ("position", "velocity")
        ),
        without=tuple(form.get("without", ())),
        order=form.get("order", 0),
        stops=form.get("stops", False),
        smooth=form.get("smooth", False),
        modes=count if what == "mode" else 0,
    )


def _numbered(forms: Iterable[Mapping[str, Any]], count: int) -> list[tuple[dict[str, Any], int]]:
    """Return each entry with its number, those of a ball or a mode once for each; 0 for what belongs to none."""
    return [
        ({key: value for key, value in form.items() if key != "from"}, number)
        for form in forms
        for number in (range(form.get("from", 1), count + 1) if "each" in form else (0,))
    ]


def _parameter(form: dict[str, Any], number: int, own: Iterable[str]) -> Parameter:
    what = form.pop("each", "")
    if number:
        form = form | _of_one(form, what, number)
        for name in own:
            form["physical"] = re.sub(rf"\b{name}\b", f"{name}_{number}", form.get("physical", ""))
    return Parameter(**_ranged(form))


def _coordinate(form: dict[str, Any], what: str, number: int) -> Coordinate:
    return Coordinate(**_ranged(form | (_of_one(form, what, number) if number else {})))


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


def _body(form: dict[str, Any], number: int) -> Body:
    what = form.get("each", "")
    name = f"{form['name']}_{number}" if number else form["name"]
    return Body(name, _coordinate(form["position"], what, number), _coordinate(form["velocity"], what, number))


def _contact(form: dict[str, Any], ball: int) -> Contact:
    if not ball:
        return Contact(**form)
    return Contact(f"{form['letter']}{ball}", form["sign"], f"{form['text']}, ball {ball}", ball)


def _of_one(form: Mapping[str, Any], what: str, number: int) -> dict[str, Any]:
    """Return what an entry says of one ball, or one mode."""
    found = {"name": f"{form['name']}_{number}", "text": f"{form['text']}, {what} {number}"}
    if "symbol" in form:
        found["symbol"] = _subscript(form["symbol"], number)
    if "label" in form:
        found["label"] = f"{form['label']} {number}"
    return found


def _subscript(symbol: str, number: int) -> str:
    """Return a symbol with the number of a ball or a mode.

    Examples
    --------
    >>> _subscript("r", 1), _subscript("x_2", 3), _subscript("x_2'", 3)
    ('r_{1}', 'x_{2,3}', "x_{2,3}'")
    """
    stem, prime = symbol.rstrip("'"), "'" * (len(symbol) - len(symbol.rstrip("'")))
    base, _, index = stem.partition("_")
    return f"{base}_{{{','.join(filter(None, (index, str(number))))}}}{prime}"
