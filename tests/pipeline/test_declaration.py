"""Declarations: what is read, and what is said about mistakes."""

import pytest

from vines.errors import DeclarationError, FileMissingError, ParameterError, UnknownNameError
from vines.pipeline import Kind, available, find, kind, kinds, load, register

TEXT = """
    title = "toys"
    source = "Fig. 0"
    [params]
    mu = 1
    [stages.up]
    kind = "toy"
    gain = 2
    vary.A = { from = 0.1, to = 0.5, count = 5 }
    carry = "A"
    [stages.total]
    kind = "total"
    needs = ["up"]
"""


def test_a_declaration_is_typed_data_with_defaults(lab):
    pipeline = load(lab.declare(TEXT), root=lab.folder)
    assert (pipeline.name, pipeline.title, pipeline.source) == ("toys", "toys", "Fig. 0")
    up = pipeline.stages["up"]
    assert up.params == {"mu": 1.0}
    assert (up.options.gain, up.options.steps) == (2.0, 1)
    assert up.axes[0].count == 5
    assert (up.carry.axis, up.carry.direction) == ("A", "up")
    assert pipeline.order == ("up", "total")
    assert pipeline.select(["up"]) == ("up",)


def test_overrides_replace_values_by_dotted_key(lab):
    changes = {"stages.up.vary.A.count": "9", "params.mu": 0.2, "stages.total.label": "a b", "title": "7"}
    with pytest.raises(DeclarationError, match="title is 7; a text"):
        load(lab.declare(TEXT), changes, root=lab.folder)
    del changes["title"]
    pipeline = load(lab.declare(TEXT), changes, root=lab.folder)
    assert pipeline.stages["up"].axes[0].count == 9
    assert pipeline.stages["up"].params["mu"] == 0.2
    assert pipeline.stages["total"].options.label == "a b"


@pytest.mark.parametrize(
    ("before", "after", "words"),
    [
        ("title", "titel", "unknown key 'titel': did you mean 'title'"),
        ("[params]", "[parms]", "unknown key 'parms': did you mean 'params'"),
        ("mu = 1", "mju = 1", "params: unknown key 'mju'"),
        ("mu = 1", 'mu = "x"', "params.mu is 'x', which is not a number"),
        ("mu = 1", "mu = true", "params.mu is true, which is not a number; give 1"),
        ("mu = 1", "mu = nan", "params.mu is NaN; give a finite"),
        ("gain = 2", "gian = 2", "stages.up: unknown key 'gian': did you mean 'gain'"),
        ("gain = 2", 'gain = "2"', "stages.up.gain is '2'; allowed is a number"),
        ("gain = 2", "gain = inf", "stages.up.gain is Infinity; give a finite"),
        ('"toy"', '"toi"', "stages.up.kind: unknown kind 'toi': did you mean 'toy'"),
        ('kind = "toy"', "", "stages.up: 'kind' is missing"),
        ('kind = "toy"', "kind = 3", "stages.up.kind is 3; a text"),
        ("vary.A", "vary.B", "stages.up.vary: unknown key 'B'"),
        ("vary.A", "vary.A.B", "unknown key 'B'"),
        ("gain = 2", "params.A = 1", "A is both fixed under params and varied"),
        ("vary.A = { from = 0.1, to = 0.5, count = 5 }", "", "parameter 'A' is missing"),
        ('carry = "A"', 'carry = "mu"', "carry: axis 'mu' is not varied"),
        ('carry = "A"', 'carry = { axis = "A", direction = "left" }', "direction is 'left'; allowed: up, down"),
        ('carry = "A"', 'carry = { axis = "A", start = { from = "x" } }', "carry.start.from: 'x'"),
        (
            'carry = "A"',
            'needs = ["total"]',
            "stages.up.needs is ['total']; the kind 'toy' takes no results of other stages: leave it out, or start",
        ),
        ('["up"]', '["upp"]', "stages.total.needs: unknown stage 'upp': did you mean 'up'"),
        ('["up"]', '["total"]', "total needs total: a stage cannot need itself"),
        ('["up"]', '["up", "up"]', "names a stage twice"),
        ('["up"]', '"up"', "list names of stages"),
        ("[stages.total]", "[stages.Total]", "a stage cannot be called 'Total'"),
        ('title = "toys"', "title = ", "not a TOML file"),
    ],
)
def test_a_mistake_is_one_line_with_file_key_and_remedy(lab, before, after, words):
    path = lab.declare(TEXT.replace(before, after, 1))
    with pytest.raises(DeclarationError) as caught:
        load(path, root=lab.folder)
    assert words in str(caught.value)
    assert str(caught.value).startswith(str(path))
    assert "\n" not in str(caught.value)
    assert not lab.store.data.exists()


def test_a_circle_of_stages_is_shown(lab):
    circle = TEXT + '    [stages.more]\n    kind = "total"\n    needs = ["total"]\n'
    with pytest.raises(DeclarationError, match=r"total needs more needs total|more needs total needs more"):
        load(lab.declare(circle.replace('["up"]', '["more"]')), root=lab.folder)


@pytest.mark.parametrize("name", ["select", "Upper", "main", "7up"])
def test_names_that_sql_keeps_are_refused(lab, name):
    with pytest.raises(DeclarationError, match="a pipeline cannot be called"):
        load(lab.declare(TEXT, name), root=lab.folder)


def test_no_stages_is_a_mistake(lab):
    with pytest.raises(DeclarationError, match="no stages"):
        load(lab.declare('title = "empty"'), root=lab.folder)


def test_overrides_of_unknown_places_are_mistakes(lab):
    path = lab.declare(TEXT)
    with pytest.raises(DeclarationError, match=r"no stage 'upp' to set stages\.upp\.gain: did you mean 'up'"):
        load(path, {"stages.upp.gain": 1}, root=lab.folder)
    with pytest.raises(DeclarationError, match=r"stages\.up\.gain is 2, not a table"):
        load(path, {"stages.up.gain.x": 1}, root=lab.folder)


def test_the_kind_checks_the_corners_of_the_box(lab):
    seen = []

    def check(params, options):
        seen.append((params["A"], params["mu"], options.gain))
        if params["A"] > 0.4:
            raise ParameterError(f"A is {params['A']:g}, allowed is A <= 0.4: it is a toy")

    toy = kind("toy")
    register(
        Kind(
            **{name: getattr(toy, name) for name in Kind.__dataclass_fields__ if name != "check"},
            check=check,
        )
    )
    with pytest.raises(ParameterError, match=r"stages\.up: A is 0\.5, allowed"):
        load(lab.declare(TEXT), root=lab.folder)
    assert seen == [(0.1, 1.0, 2.0), (0.5, 1.0, 2.0)]


def test_pipelines_are_found_by_name_and_by_path(lab):
    path = lab.declare(TEXT)
    (lab.folder / "pipelines" / "claims.toml").write_text("[a]\nvalue = 1\n")
    assert find("toys", lab.folder) == path
    assert find(str(path), lab.folder) == path
    found = available(lab.folder)
    assert found["toys"] == path
    assert "claims" not in found
    with pytest.raises(UnknownNameError, match="did you mean 'toys'"):
        find("toyz", lab.folder)
    with pytest.raises(FileMissingError, match="no such file"):
        find("nowhere/toys.toml", lab.folder)
    with pytest.raises(FileMissingError, match="no such file"):
        load(lab.folder / "gone.toml")


def test_kinds_that_contradict_themselves_are_refused(lab):
    toy = kind("toy")
    fields = {name: getattr(toy, name) for name in Kind.__dataclass_fields__}
    for change in ({"tables": ()}, {"shape": "whole"}, {"body": "nowhere"}):
        with pytest.raises(DeclarationError, match="kind 'toy'"):
            register(Kind(**{**fields, **change}))
    assert "toy" in kinds()
