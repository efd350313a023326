"""``vines solve``: what a person reads, what a machine reads, and how it fails."""

import functools
import json
import re
import shlex
from pathlib import Path

import pytest
from click.testing import CliRunner

from vines.cli._solve import command
from vines.errors import OrbitNotFound, ParameterError, UnknownNameError
from vines.logs import read
from vines.model import Params
from vines.orbits import all_orbits, find_orbit

PAGE = Path(__file__).resolve().parents[2] / "docs" / "systems.md"


@functools.cache
def solve(*arguments):
    result = CliRunner().invoke(command, list(arguments))
    if result.exception is not None and not isinstance(result.exception, SystemExit):
        raise result.exception
    assert result.exit_code == 0
    return result.output


def test_a_person_reads_everything_about_an_orbit():
    text = solve("LRLR/2T", "--mu", "0.01", "--A", "0.021")
    orbit = find_orbit("LRLR/2T", Params(mu=0.01, A=0.021))
    assert text.startswith("2:2/2T, in the paper 1:1/2T (LRLR/2T): asymmetric, stable, admissible\n")
    for value in (*orbit.t, *orbit.w_dot, *abs(orbit.multipliers)):
        assert f"{value:.10f}" in text
    for value in (orbit.measures.kinetic_ratio, orbit.measures.max_abs_x1, orbit.measures.base_work):
        assert f"{value:.10g}" in text
    assert "of that without ball" in text
    assert "of that with the ball locked" in text


def test_an_inadmissible_orbit_says_where_it_meets_a_wall():
    text = solve("LR", "--mu", "0.01", "--A", "0.08")
    orbit = find_orbit("LR", Params(mu=0.01, A=0.08))
    assert not orbit.admissible
    side = "L" if orbit.violation_side > 0 else "R"
    assert f"would meet {side} at t = {orbit.violation_time:.10g}" in text


def test_all_orbits_are_printed_with_what_is_known_of_others():
    text = solve("LR", "--mu", "0.01", "--A", "0.019", "--all")
    assert text.startswith(
        "3 orbits of this word, and no more (all flight times searched; orbits that stick have other words)\n"
    )
    assert text.count("Floquet multipliers") == 3


def test_a_machine_reads_json():
    row = json.loads(solve("LLR", "--mu", "0.01", "--A", "0.023", "--json"))
    assert row["name"] == "2:1"
    assert row["violation_time"] is None
    found = json.loads(solve("LR", "--mu", "0.01", "--A", "0.019", "--Omega", "1", "--lam", "0.012", "--all", "--json"))
    assert found["complete"] is True
    assert len(found["orbits"]) == len(all_orbits("LR", Params(mu=0.01, A=0.019, lam=0.012)))


def test_no_orbit_is_an_error_of_one_line_and_exit_code_1():
    for extra in ([], ["--all"], ["--json"]):
        with pytest.raises(OrbitNotFound, match="raise A") as caught:
            solve("LR", "--mu", "0.01", "--A", "0.001", *extra)
        assert "\n" not in str(caught.value)
        assert caught.value.exit_code == 1
    with pytest.raises(ParameterError, match="is not a word"):
        solve("1:1", "--mu", "0.01", "--A", "0.001")


@pytest.mark.parametrize(
    ("system", "shown"),
    [
        ("parallel", ["1:1|1:1 (L1L2R1R2): symmetric, stable", ".5134856457", "\nL2 "]),  # check value a3
        ("parallel", ["1:1 (LR): asymmetric", "\nR  ", "1.5737985132"]),  # f1: one ball, tilted
        ("hybrid", ["1:1 (LR)", " x3 ", "mu_n = 0.01"]),
        ("cubic_barriers", ["1:1 (LR)", ".8362633843"]),  # c3
        ("cubic_barriers", ["0:0 (-)", ".2719622103", "nothing is hit"]),  # c8
        ("impact_pair", ["2:1 (LLR)", "1.7071691101"]),  # d4
        ("drag", ["1:1 (LR)", "delta = 0.1"]),
        ("friction", ["1:1 (LsR)", "\ns  ", "lost by the ball on its way"]),
        ("duffing", ["1:1 (LR)", "alpha = 2"]),
        ("modes", ["1:1 (LR)", "omega = 1, 1.9"]),
    ],
    ids=lambda each: each if isinstance(each, str) else "",
)
def test_the_commands_of_the_page_of_systems_solve_what_they_say(system, shown):
    commands = [shlex.split(each) for each in re.findall(r"`vines solve ([^`]* --system [^`]*)`", PAGE.read_text())]
    texts = [solve(*each) for each in commands if each[each.index("--system") + 1] == system and "…" not in each]
    assert any(all(part in text for part in shown) for text in texts)


def test_numbers_of_another_system_as_json_and_its_name_mistyped():
    row = json.loads(solve("LR", "--system=drag", "--mu", "0.01", "--A", "0.02", "--delta", "0.01", "--json"))
    assert (row["word"], row["delta"]) == ("LR", 0.01)
    assert "max|x1|" not in solve("LLR", "--system", "impact_pair", "--B", "0.95", "--G", "0.15", "--r", "0.5")
    with pytest.raises(UnknownNameError, match="did you mean 'impact_pair'"):
        solve("LR", "--system", "impact_pear", "--B", "0.6")


def test_log_of_one_period(project):
    project.vines("solve", "LR", "--mu", "0.01", "--A", "0.02", "--log", project.root / "orbit.mcap")
    log = read(project.root / "orbit.mcap")
    assert (log.complete, log.word, log.impacts.num_rows) == (True, "LR", 2)
    refused = project.vines("solve", "LR", "--mu", "0.01", "--A", "0.02", "--all", "--log", "x.mcap", check=False)
    assert (refused.returncode, refused.stderr.count("\n")) == (2, 1)
