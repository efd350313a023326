"""The surface that users rely on is there: names, commands, kinds, tables; the design's too, where it lies beside."""

import re
from pathlib import Path

import pytest

import vines
from vines import schema
from vines.cli._app import COMMANDS
from vines.cli._rig import COMMANDS as RIG
from vines.stages import list_kinds

NAMES = [
    "Attractor",
    "Branch",
    "Ensemble",
    "Exits",
    "Orbit",
    "OrbitNotFound",
    "OrnsteinUhlenbeck",
    "Params",
    "PhysicalParams",
    "Scatter",
    "Study",
    "Trajectory",
    "VinesError",
    "Word",
    "all_orbits",
    "ball_locked",
    "classify_many",
    "continue_orbit",
    "ensemble",
    "exits",
    "find_orbit",
    "no_ball",
    "query",
    "run",
    "settle",
    "simulate",
    "study",
    "switch_branch",
    "systems",
    "table",
]
OF_AN_ORBIT = [
    "admissible",
    "max_multiplier",
    "measures",
    "min_clearance",
    "multipliers",
    "name",
    "orbit_id",
    "params",
    "phase",
    "residual",
    "side",
    "stable",
    "states",
    "symmetric",
    "t",
    "w_dot",
    "word",
]
OF_AN_ATTRACTOR = ["m", "measures", "n", "name", "p", "regime", "settled", "sticks"]
SHELL = [
    "browse",
    "check",
    "diff",
    "export",
    "gc",
    "graph",
    "init",
    "kinds",
    "list",
    "merge",
    "plots",
    "query",
    "recover",
    "report",
    "rig",
    "run",
    "schema",
    "solve",
    "status",
    "tables",
    "verify",
    "view",
]
RIG_SHELL = ["campaign", "compare", "ingest", "init", "inspect", "reconstruct", "synth"]
KINDS = [
    "atlas",
    "basins",
    "branch",
    "check",
    "compare",
    "curve",
    "dimensionless",
    "exits",
    "figure",
    "ingest",
    "optimum",
    "reconstruct",
    "reduced",
    "report",
    "sweep",
    "synth",
    "trajectory",
    "transient",
]
VIEWS = ["bifurcations", "branches", "checks", "comparisons", "impacts", "logs", "orbits", "points"]

DESIGN = Path(__file__).resolve().parents[2] / "shared" / "DESIGN.md"
TO_COME = {"figure", "next", "report", "split", "watch"}
"""What the design has for the capabilities after this release."""


def _has(form, name):
    return hasattr(form, name) or any(name in getattr(each, "__annotations__", {}) for each in form.__mro__)


@pytest.mark.parametrize("name", NAMES)
def test_a_name_is_there(name):
    assert getattr(vines, name) is not None
    assert name in dir(vines)


def test_orbits_and_attractors_tell_what_they_promise():
    assert [name for name in OF_AN_ORBIT if not _has(vines.Orbit, name)] == []
    assert [name for name in OF_AN_ATTRACTOR if not _has(vines.Attractor, name)] == []


def test_commands_kinds_and_tables_are_there():
    assert set(SHELL) <= set(COMMANDS)
    assert set(RIG_SHELL) <= set(RIG)
    assert set(KINDS) <= {row["name"] for row in list_kinds()}
    assert set(VIEWS) <= set(schema.tables())


@pytest.mark.skipif(not DESIGN.is_file(), reason="the design lies in no folder beside this one")
def test_what_the_design_names_is_there():
    text = DESIGN.read_text("utf-8")
    python = _block(text, "Python surface", "python")
    names = set(re.findall(r"\bvines\.([A-Za-z_]+)", python)) | set(re.findall(r"from vines import (\w+)", python))
    assert {name for name in names - TO_COME if not hasattr(vines, name)} == set()
    of_an_orbit = set(re.findall(r"\borb\.(\w+)", python))
    assert {name for name in of_an_orbit if not _has(vines.Orbit, name)} == set()
    shell = _block(text, "Command line", "")
    lines = re.sub(r"\[[^\]]*\]|\"[^\"]*\"", "", shell).splitlines()
    rig = [line.removeprefix("vines rig") for line in lines if line.startswith("vines rig")]
    others = [line for line in lines if line.startswith("vines ") and not line.startswith("vines rig")]
    assert _commands(others) - TO_COME <= set(COMMANDS)
    assert _commands(rig) - TO_COME <= set(RIG)
    kinds = text[text.index("\nKinds: ") :]
    assert set(re.findall(r"`(\w+)`", kinds)) - {row["name"] for row in list_kinds()} == set()
    views = set(re.findall(r"^\| `(\w+)` \|", text, re.MULTILINE))
    assert views
    assert views <= set(schema.tables())


def _block(text, head, language):
    after = text[text.index(f"## {head}") :]
    return after[after.index(f"```{language}\n") :].split("```")[1]


def _commands(lines):
    """Return the first word of each alternative, such as ``init`` and ``list`` of ``vines init DIR | list``."""
    parts = [re.split(r"\s{3,}", part.removeprefix("vines").strip()) for line in lines for part in line.split(" | ")]
    return {words[0].split()[0] for words in parts if words[0] and words[0].split()[0].islower()}
