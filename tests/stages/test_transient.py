"""The kind `transient` from declaration to table."""

import pytest

import vines
from vines.dynamics import decay, simulate
from vines.errors import DeclarationError, ParameterError
from vines.stages import run

DECAYS = """
title = "decays"
[params]
mu = 0.02
[stages.over]
kind = "transient"
periods = 20
vary.V = [0.9, 2.0]
"""


@pytest.fixture
def decays(project, monkeypatch):
    monkeypatch.setenv("VINES_ROOT", str(project.root))

    def declare(text):
        (project.root / "pipelines" / "decays.toml").write_text(text)
        return project

    return declare


def test_rows_say_what_the_run_says(decays):
    decays(DECAYS)
    run("decays")
    below, above = vines.query("select * from transients order by V").to_pylist()
    assert (below["impacts"], below["t_first"], below["impact_share"]) == (0, None, 0.0)
    found = decay(simulate(vines.Params(mu=0.02, A=0.0), v1=2.0, v2=0.0, periods=20))
    assert (above["impacts"], above["impact_share"], above["t_tenth"]) == (54, found.impact_share, found.times[0])
    assert round(above["energy"] * above["impact_share"], 10) == 0.7188333001
    assert above["t_hundredth"] is None


@pytest.mark.parametrize(
    ("change", "error", "text"),
    [
        (("[0.9, 2.0]", "[0.0, 2.0]"), ParameterError, "V is 0, allowed is V != 0"),
        (("mu = 0.02", "mu = 0.02\nA = 0.1"), DeclarationError, "unknown key 'A'"),
        (
            ('kind = "transient"', 'kind = "transient"\nsystem = "impact_pair"'),
            DeclarationError,
            "cannot do",
        ),
    ],
)
def test_what_does_not_decay_is_refused(decays, change, error, text):
    decays(DECAYS.replace(*change))
    with pytest.raises(error, match=text) as caught:
        run("decays")
    assert "\n" not in str(caught.value)
