"""Options of kinds: what they refuse, in one line, and that nothing asks for the name of a kind."""

import ast
from pathlib import Path

import pytest

import vines
from vines.errors import DeclarationError
from vines.pipeline import json_schema
from vines.stages import describe_kind, list_kinds, load_pipeline, register_kinds

SWEEP = 'kind = "sweep"\nparams.mu = 0.01\nvary.A = [0.01, 0.02]\n'
BRANCH = 'kind = "branch"\nparams.mu = 0.01\nword = "LR"\nvary.A = { from = 0.01, to = 0.02 }\n'
CURVE = (
    BRANCH.replace("branch", "curve").replace("params.mu = 0.01\n", "")
    + 'type = "fold"\nvary.mu = { from = 0.01, to = 0.02 }\n'
)
ATLAS = 'kind = "atlas"\nparams.mu = 0.01\nvary.Omega = [1.0]\namplitude = { from = 0.01, to = 0.02, count = 3 }\n'
BASINS = """kind = "basins"
params.A = 0.01
params.mu = 0.01
x = { name = "x2", from = -1.0, to = 1.0, count = 4 }
y = { name = "v2", from = -1.0, to = 1.0, count = 4 }
"""
SYNTH = 'kind = "synth"\namplitudes = [0.01, 0.02]\n'


def declare(root, text):
    (root / "pipelines").mkdir(exist_ok=True)
    path = root / "pipelines" / "study.toml"
    path.write_text(f"[stages.one]\n{text}")
    return load_pipeline(str(path))


@pytest.mark.parametrize(
    ("text", "line", "said"),
    [
        (SWEEP, "record = 1", "stages.one.record is 1, allowed is record >= 2"),
        (SWEEP, "settle = 1.5", "stages.one.settle is 1.5; allowed is a whole number"),
        (SWEEP, "start = { x1 = 0.1, v3 = 0.1 }", "stages.one.start: unknown key 'v3': allowed: v1, v2, x1, x2"),
        (SWEEP, 'start = "rendom"', "stages.one.start is 'rendom': did you mean 'random'"),
        (BRANCH, 'families = "al"', "stages.one.families is 'al': did you mean 'all'"),
        (BRANCH, "points = -3", "stages.one.points is -3, allowed is points >= 2"),
        (CURVE, "step = 1.5", "stages.one.step is 1.5, allowed is step <= 1"),
        (CURVE, "step = 0.0", "stages.one.step is 0, allowed is step > 0"),
        (ATLAS, "length = 13", "stages.one.length is 13, allowed is length <= 12"),
        (ATLAS.replace("count = 3", "count = 1"), "", "stages.one.amplitude.count is 1, allowed is count >= 2"),
        (BASINS.replace('"v2"', '"w2"'), "", "stages.one.y.name is 'w2': allowed: phase, v1, v2, x1, x2"),
        (SYNTH.replace("0.01", "-0.01"), "", r"stages.one.amplitudes[0] is -0.01, allowed is amplitudes[0] > 0"),
        (SYNTH.replace("0.01, 0.02", ""), "", r"stages.one.amplitudes is [], allowed is length >= 1"),
    ],
)
def test_what_is_out_of_range_is_one_line(tmp_path, text, line, said):
    with pytest.raises(DeclarationError) as caught:
        declare(tmp_path, text + line)
    assert said in str(caught.value)
    assert "\n" not in str(caught.value)


def test_basins_may_be_refined_by_a_declaration(tmp_path):
    stage = declare(tmp_path, BASINS + "refine = 2\n").stages["one"]
    assert (stage.options.refine, stage.refine) == (2, None)
    assert "refine" in [row["option"] for row in describe_kind("basins")["options"]]


def test_every_option_says_what_it_is():
    register_kinds()
    definitions = json_schema()["$defs"]
    silent = [
        f"{name}.{key}"
        for name, form in definitions.items()
        for key, option in form.get("properties", {}).items()
        if key not in ("plot", "kind") and "description" not in option
    ]
    assert silent == []


def test_nothing_asks_for_the_name_of_a_kind():
    """What a kind can do is in its spec, so that a kind of another package has the same rights."""
    names = {row["name"] for row in list_kinds()}
    package = Path(vines.__file__).parent
    asked = [
        f"{path.relative_to(package)}:{node.lineno}: {ast.unparse(node)}"
        for path in sorted(package.rglob("*.py"))
        if path.parent != package / "stages" / "kinds" or path.name.startswith("_")
        for node in ast.walk(ast.parse(path.read_text("utf-8")))
        if _asks(node, names)
    ]
    assert asked == []


def _asks(node, names):
    """Whether a comparison has the name of a kind beside a kind, or a table is looked up by what a kind is called."""
    if isinstance(node, ast.Compare):
        words = {inner.value for inner in ast.walk(node) if isinstance(inner, ast.Constant) and inner.value in names}
        return bool(words) and "kind" in ast.unparse(node) and ".tables" not in ast.unparse(node)
    if isinstance(node, ast.Subscript):
        return _is_kind(node.slice)
    if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute) and node.func.attr == "get" and node.args:
        return _is_kind(node.args[0]) and ast.unparse(node.func.value) not in ("KINDS", "kinds()")
    return False


def _is_kind(node):
    return ast.unparse(node).endswith(("['kind']", ".kind", ".kind.name"))
