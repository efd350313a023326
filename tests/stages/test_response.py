"""Declarations of figures of energy measures: what can be refused before anything is computed."""

import pytest

from vines.errors import DeclarationError
from vines.pipeline import Declaration, span
from vines.stages import load_pipeline


def declared(plot="response", vary=None, carry="mu", **cell):
    study = Declaration("mine", params={"Omega": 1.0})
    vary = vary or {"A": [0.03, 0.1], "mu": span(0.1, 0.5, 5)}
    given = {"carry": carry} if carry else {}
    study.stage("up", "sweep", vary=vary, **given)
    study.stage("other", "sweep", vary={"mu": [0.1], "A": span(0.1, 0.2, 3)}, carry="A")
    cells = [{"show": "energy", "of": ["up"], **cell}]
    study.stage("figure", "figure", needs=["up", "other"], plot=plot, cells=cells)
    return study


def test_a_response_is_accepted():
    figure = load_pipeline(declared(where={"A": 0.1, "Omega": 1.0})).stages["figure"]
    assert figure.options.cells[0].where == {"A": 0.1, "Omega": 1.0}
    assert figure.options.cells[0].colours == ("red", "green", "blue")


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({"show": "gap"}, r"cell 1 \(gap\): a response shows energy, max_abs_x1 or w_dot"),
        ({"carry": None}, "shows stages of kind 'sweep' that are carried along one axis"),
        ({"of": ["up", "other"]}, "shows stages of kind 'sweep' that are carried along one axis"),
        ({"of": ["upp"]}, "'upp' is not needed: did you mean 'up'"),
        ({"where": {"A": 0.2}}, "up has no A = 0.2; the nearest of its 2 values is 0.1"),
        ({"where": {"Omega": 1.1}}, "up has no Omega = 1.1; the nearest of its 1 values is 1"),
        ({"where": {"omega": 1.0}}, "up has no omega"),
        ({"plot": "sheet"}, "a sheet shows ends, gap, .* or phase$"),
        ({"plot": "bifurcation"}, "unknown key 'cells'"),
        ({"colours": ["pink"]}, "pink"),
    ],
)
def test_a_mistake_is_one_line(changed, said):
    with pytest.raises(DeclarationError, match=said) as found:
        load_pipeline(declared(**changed))
    assert "\n" not in str(found.value)
