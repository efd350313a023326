"""What a sweep tells of motion that never repeats, or only after more periods than it looks for."""

import json

import pytest

DECLARED = """
title = "irregular"
[params]
mu = 0.007796
Omega = 0.9574
r = 0.7107
lam = 0.1331
[stages.short]
kind = "sweep"
vary.A = [0.010240977443609]
settle = 2000
keep = 0
[stages.long]
kind = "sweep"
vary.A = [0.010240977443609]
settle = 2000
largest_p = 48
[stages.chaos]
kind = "sweep"
params.mu = 0.01
params.Omega = 1.0
params.r = 0.65
params.lam = 0.012
vary.A = [0.015, 0.03]
keep = 0
"""


@pytest.fixture
def rows(project):
    (project.root / "pipelines" / "irregular.toml").write_text(DECLARED, encoding="utf-8")
    project.vines("run", "irregular", "--quiet")
    asked = "select * from points where pipeline = 'irregular' order by stage, A"
    told = json.loads(project.vines("query", asked, "--format", "json").stdout)
    return {(row["stage"], row["A"] > 0.02): row for row in told}


def test_errors_escape_and_long_periods_stand_in_the_table(rows):
    short, long = rows["short", False], rows["long", False]
    assert (short["regime"], short["name"]) == ("unsettled", None)
    assert "largest_p = 48 names it" in short["reason"]
    assert (long["regime"], long["name"], long["record_periods"]) == ("periodic", "16:16/48T", 96)
    regular, chaos = rows["chaos", False], rows["chaos", True]
    for name in ("kinetic_ratio_error", "max_abs_x1_error", "rms_x1_error"):
        assert regular[name] == 0
        assert chaos[name] > 0
        assert short[name] is None
    assert (regular["watched"], regular["escape_rate"]) == (0, None)
    assert chaos["watched"] >= 640
    assert chaos["escape_rate"] == pytest.approx(2.9957 / chaos["watched"], rel=1e-4)
