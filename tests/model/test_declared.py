"""Systems as their files declare them: one form for all, and what the files may not say."""

import importlib
import math
import re

import pytest

from vines import systems
from vines.errors import ParameterError, SchemaError, UnknownNameError
from vines.model import LAM_TABLE_1, VI_NES, Params, PhysicalParams, dimensionless, read_system, system_names

ALL = [
    read_system(name, balls)
    for name, balls in (
        ("vi_nes", 0),
        ("cubic_barriers", 0),
        ("drag", 0),
        ("duffing", 0),
        ("friction", 0),
        ("hybrid", 0),
        ("impact_pair", 0),
        ("modes", 1),
        ("modes", 6),
        ("parallel", 1),
        ("parallel", 8),
    )
]


def test_the_files_are_the_systems():
    assert {each.name for each in ALL} == set(system_names()) == set(systems.names())


@pytest.mark.parametrize("system", ALL, ids=lambda each: f"{each.name}{each.balls or each.modes or ''}")
def test_every_system_has_what_a_system_has(system):
    names = [each.name for each in (*system.parameters, *system.start)]
    assert len(set(names)) == len(names)
    assert all(each.symbol and each.label and each.text for each in system.parameters)
    letters = system.mirror.letters
    assert {letters[letters[contact.letter]] == contact.letter for contact in system.contacts} == {True}
    assert {contact.sign for contact in system.contacts} == {-1, 1}
    assert set(system.mirror.broken_by) <= set(names)
    package, _, form = system.parameters_of.partition(":")
    assert getattr(importlib.import_module(package), form) is systems.parameters(system.name)
    si = {each.name for each in (*system.rig, *system.run)}
    for each in system.parameters:
        assert set(re.findall(r"[A-Za-z]\w*", each.physical)) - {"sin", "sqrt"} <= si


def test_the_damping_is_that_of_table_1():
    assert 2.53 / math.sqrt(11680.0 * 3.807) == LAM_TABLE_1
    assert PhysicalParams().lam == LAM_TABLE_1
    assert VI_NES.phase.allowed.most == math.nextafter(2 * math.pi, 7)


def test_formulas_say_what_the_class_of_the_rig_computes():
    given = {"E": 0.3e-3, "omega": 57.0, "m": 0.04, "M": 4.0, "c": 2.0, "k": 12000.0, "b": 0.02}
    rig = PhysicalParams(**{name: given[name] for name in ("M", "c", "k", "b")})
    p = rig.dimensionless(E=given["E"], omega=given["omega"], m=given["m"])
    assert Params(**dimensionless(VI_NES, given)) == p


@pytest.mark.parametrize(
    ("call", "error", "text"),
    [
        (lambda: read_system("impact_pear"), UnknownNameError, "did you mean 'impact_pair'"),
        (lambda: read_system("impact_pair", 2), SchemaError, "one ball, which has no number, not 2"),
        (lambda: read_system("parallel", 9), SchemaError, "1 to 8 balls, not 9"),
        (lambda: read_system("modes", 7), SchemaError, "1 to 6 modes, not 7"),
        (lambda: read_system("parallel", 2, digest="0"), SchemaError, "write the new one into the code"),
        (lambda: dimensionless(VI_NES, {"mass": 1}), ParameterError, "unknown quantity 'mass' in SI units"),
        (lambda: dimensionless(VI_NES, {"E": -1}), ParameterError, "E is -1 m, allowed is E >= 0"),
        (
            lambda: dimensionless(read_system("impact_pair"), {"tilt": 3}),
            ParameterError,
            "tilt alone gives no parameter; give half_length and omega beside it",
        ),
    ],
)
def test_bad_calls_are_refused_in_one_line(call, error, text):
    with pytest.raises(error, match=re.escape(text)) as caught:
        call()
    assert "\n" not in str(caught.value)
