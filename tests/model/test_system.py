"""The declaration of the system, and what has to agree with it."""

import dataclasses
import math

import numpy as np
import pytest

from vines import model
from vines.errors import ParameterError
from vines.model import PARAMETER_NAMES, START_NAMES, STATE_NAMES, VI_NES, Params, PhysicalParams, Range


def test_fields_are_the_declared_parameters_with_their_defaults():
    for cls, declared in ((Params, VI_NES.parameters), (PhysicalParams, VI_NES.rig)):
        assert [field.name for field in dataclasses.fields(cls)] == [each.name for each in declared]
        for field, each in zip(dataclasses.fields(cls), declared, strict=True):
            assert field.default == (dataclasses.MISSING if each.default is None else each.default)


def test_places_are_those_of_the_names():
    places = {"MASS": "mu", "AMPLITUDE": "A", "FREQUENCY": "Omega", "RESTITUTION": "r", "DAMPING": "lam"}
    assert {getattr(model, place): name for place, name in places.items()} == dict(enumerate(PARAMETER_NAMES))
    assert [STATE_NAMES[k] for k in (model.X1, model.V1, model.X2, model.V2)] == ["x1", "v1", "x2", "v2"]
    assert (*STATE_NAMES, "phase") == START_NAMES


@pytest.mark.parametrize("parameter", VI_NES.parameters, ids=lambda each: each.name)
def test_params_refuse_what_lies_outside_the_declared_range(parameter):
    good = {"mu": 0.01, "A": 0.02}
    allowed = parameter.allowed
    for end, is_out, side in ((allowed.least, allowed.above, -1), (allowed.most, allowed.below, 1)):
        if math.isinf(end):
            continue
        beyond = end if is_out else math.nextafter(end, side * math.inf)
        with pytest.raises(ParameterError, match=rf"^{parameter.name} is .*, allowed is .*{parameter.name}") as caught:
            Params(**good | {parameter.name: beyond})
        assert "\n" not in str(caught.value)
        Params(**good | {parameter.name: math.nextafter(end, -side * math.inf) if is_out else end})


@pytest.mark.parametrize("allowed", [Range(), Range(0), Range(0, above=True), Range(0, 1), Range(-1, 2, below=True)])
def test_a_range_holds_for_arrays_as_for_numbers(allowed):
    values = np.array([-1.0, -5e-324, 0.0, 5e-324, 1.0, 2.0, np.nan, 3.0])
    assert allowed.holds(values).tolist() == [bool(allowed.holds(value)) for value in values.tolist()]
    assert not allowed.holds(math.nan)


def test_the_mirror_is_its_own_inverse():
    letters = VI_NES.mirror.letters
    assert {letters[letters[contact.letter]] == contact.letter for contact in VI_NES.contacts} == {True}
    assert VI_NES.mirror.sign**2 == 1
    assert math.isclose(2 * VI_NES.mirror.shift % 1, 0)


def test_letters_come_from_signs():
    assert VI_NES.letters(model.Word("LLR").sides) == "LLR"
    assert VI_NES.letters(np.array([0.3, -2.0])) == "LR"
