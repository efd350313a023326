"""Parameters that follow from others, quantities in SI units, and systems, as declarations say them."""

import re
from dataclasses import replace

import pytest

from vines.errors import DeclarationError, VinesError
from vines.pipeline import KINDS, load, plan, register
from vines.pipeline._grid import Grid
from vines.pipeline._links import with_links

TOY = """
    [params]
    mu = 0.2
    [stages.up]
    kind = "toy"
    vary.A = { from = 0.1, to = 0.3, count = 3 }
"""
LINKED = TOY.replace("mu = 0.2", "") + '    link.mu = "0.4 - A"\n'


def test_linked_values_are_exact_in_the_key_and_in_every_row(lab):
    path = lab.declare(LINKED)
    stage = load(path, root=lab.folder).stages["up"]
    assert with_links(stage, Grid(stage).columns(range(3)))["mu"].tolist() == [0.3, 0.2, 0.1]
    lab.run(path, jobs=1)
    rows = lab.rows("up")
    assert [(row["A"], row["mu"]) for row in rows] == [(0.1, 0.3), (0.2, 0.2), (0.3, 0.1)]
    spaced = load(lab.declare(LINKED.replace("0.4 - A", "0.40-A")), root=lab.folder)
    assert [each.state for each in plan(spaced, lab.store)] == ["up_to_date"]
    changed = plan(load(lab.declare(LINKED.replace("0.4 - A", "0.5 - A")), root=lab.folder), lab.store)
    assert "link.mu 0.4 - A → 0.5 - A" in changed[0].reason


def test_a_link_of_fixed_parameters_is_a_number(lab):
    fixed = 'params.A = 0.1\n    link.mu = "(3*A)/-(1 - 2)"'
    text = TOY.replace("vary.A = { from = 0.1, to = 0.3, count = 3 }", fixed).replace("mu = 0.2", "mu = 0.7")
    one = load(lab.declare(text), root=lab.folder).stages["up"]
    assert one.params["mu"] == 0.3
    assert one.links == {}


@pytest.mark.parametrize(
    ("change", "text"),
    [
        (('"0.4 - A"', '"0.4 - B"'), "stages.up.link.mu: unknown parameter 'B'"),
        (('"0.4 - A"', '"0.4 - mu"'), "stages.up.link: mu needs mu: a parameter cannot follow from itself"),
        (('"0.4 - A"', '"A ** 2"'), "stages.up.link.mu: 'A ** 2' is no formula"),
        (('"0.4 - A"', "3"), "stages.up.link.mu: 3 is no formula"),
        (('"0.4 - A"', '"1/(A - A)"'), "'1/(A - A)' divides by 0"),
        (('link.mu = "0.4 - A"', "link = 3"), "stages.up.link is 3; a table of keys is needed here"),
        (("link.mu", "link.nu"), "stages.up.link: unknown parameter 'nu'"),
        (("link.mu", "link.A"), "stages.up.link.A: A is also given under vary"),
        (("kind =", "params.mu = 1\n    kind ="), "stages.up.link.mu: mu is also given under params"),
    ],
)
def test_links_that_cannot_be_are_refused_in_one_line(lab, change, text):
    with pytest.raises(VinesError, match=re.escape(text)) as caught:
        load(lab.declare(LINKED.replace(*change)), root=lab.folder)
    assert "\n" not in str(caught.value)


def test_quantities_in_si_units_become_parameters(lab):
    text = TOY.replace("mu = 0.2", "").replace("[stages", "[physical]\n    m = 0.03807\n    [stages", 1)
    assert load(lab.declare(text), root=lab.folder).stages["up"].params["mu"] == 0.01
    with pytest.raises(VinesError, match="mu is given, and also follows from physical"):
        load(lab.declare(text.replace("[params]", "[params]\n    mu = 0.2")), root=lab.folder)
    with pytest.raises(VinesError, match="physical: unknown key 'mm'"):
        load(lab.declare(text.replace("m = 0.03807", "mm = 1")), root=lab.folder)


def of_several(balls):
    own = {f"mu_{ball}": None for ball in range(1, balls + 1)}
    return replace(KINDS.get("toy"), parameters={"A": None, **own}, system="parallel", balls=balls)


@pytest.fixture
def several(lab):
    register(replace(KINDS.get("toy"), systems={"parallel": of_several}))
    return lab


SEVERAL = """
    system = "parallel"
    [params]
    mu = [0.01, 0.02]
    [stages.up]
    kind = "toy"
    vary.A = [0.1, 0.2]
"""


def test_lists_are_flat_parameters_of_each_ball(several):
    stage = load(several.declare(SEVERAL), root=several.folder).stages["up"]
    assert stage.params == {"mu_1": 0.01, "mu_2": 0.02}
    own = SEVERAL.replace("vary.A", "params = { A = 0.1, mu_2 = 0.03 }\n    vary.mu_1")
    assert load(several.declare(own), root=several.folder).stages["up"].params == {"A": 0.1, "mu_2": 0.03}
    one = SEVERAL.replace("[0.01, 0.02]", "0.01").replace("vary.A", "vary.mu_3 = [0.3, 0.4]\n    vary.A")
    assert load(several.declare(one), root=several.folder).stages["up"].params == {"mu_1": 0.01, "mu_2": 0.01}


def test_a_count_of_balls_agrees_with_lists_and_is_in_no_parameter(several):
    counted = SEVERAL.replace("[params]", "[params]\n    balls = 2")
    assert load(several.declare(counted), root=several.folder).stages["up"].params == {"mu_1": 0.01, "mu_2": 0.02}
    alone = counted.replace("[0.01, 0.02]", "0.01")
    assert load(several.declare(alone), root=several.folder).stages["up"].params == {"mu_1": 0.01, "mu_2": 0.01}
    for text, message in (
        (counted.replace("balls = 2", "balls = 3"), "params.mu has 2 values, and balls = 3; give a number for all"),
        (alone.replace("vary.A", "vary.mu_3"), "stages.up: mu_3 is of ball 3, and balls = 2"),
        (alone.replace("balls = 2", "balls = 2.5"), "params.balls is 2.5; balls are counted, 1 to 8"),
        (alone.replace("parallel", "vi_nes"), "params.balls is 2; the system has one ball, which is not counted"),
    ):
        with pytest.raises(DeclarationError, match=re.escape(message)) as caught:
            load(several.declare(text), root=several.folder)
        assert "\n" not in str(caught.value)


def test_a_list_that_ends_before_the_balls_do_is_refused_and_no_default_fills_it(several):
    short = SEVERAL.replace("vary.A", "params = { A = 0.1 }\n    vary.mu_3")
    assert load(several.declare(short), root=several.folder).stages["up"].params["mu_2"] == 0.02
    longer = SEVERAL.replace("vary.A", "params = { A = 0.1, mu_4 = 0.03 }\n    vary.mu_1")
    with pytest.raises(DeclarationError, match="mu is a list of 2, and there are 4 balls; give a number for all"):
        load(several.declare(longer), root=several.folder)


def test_the_vi_nes_may_be_named_and_that_changes_no_key(lab):
    lab.run(lab.declare(TOY), jobs=1)
    named = load(lab.declare(f'    system = "vi_nes"\n{TOY}'), root=lab.folder)
    assert [each.state for each in plan(named, lab.store)] == ["up_to_date"]


@pytest.mark.parametrize(
    ("system", "text"),
    [
        (
            "impact_pair",
            "the kind 'toy' cannot do the system 'impact_pair'; it can do parallel, vi_nes; kinds that can",
        ),
        ("impact_pear", "unknown system 'impact_pear': did you mean 'impact_pair'?"),
    ],
)
def test_a_kind_refuses_a_system_that_it_cannot_do(several, system, text):
    with pytest.raises(VinesError, match=re.escape(text)) as caught:
        load(several.declare(SEVERAL.replace("parallel", system)), root=several.folder)
    assert "\n" not in str(caught.value)
