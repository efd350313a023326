"""Claims: what their file may say, what verdict they get, and what the command prints."""

import json
import math
import tomllib

import pytest

from tests.project import REPOSITORY
from vines.cli._check import page, summary
from vines.errors import DeclarationError
from vines.stages.bodies._check import verdict
from vines.stages.bodies._claims import REASONS, Claim, read_claims

CLAIMS = read_claims(REPOSITORY / "pipelines" / "claims.toml")


def declared() -> dict[str, list[str]]:
    """Return the claims that each pipeline checks."""
    found = {}
    for file in sorted((REPOSITORY / "pipelines").glob("*.toml")):
        stages = tomllib.loads(file.read_text()).get("stages", {})
        names = [name for stage in stages.values() if stage.get("kind") == "check" for name in stage["claims"]]
        if names:
            found[file.stem] = names
    return found


def test_every_claim_is_checked_by_a_pipeline():
    assert {name for names in declared().values() for name in names} == set(CLAIMS)


def test_claims_have_what_a_reader_needs():
    assert sum(claim.source == "Table 1" for claim in CLAIMS.values()) <= 4
    for name, claim in CLAIMS.items():
        assert claim.source, name
        assert claim.statement, name
        assert claim.reason in ("", *REASONS), name
        # ours is asked of rows; a query that could answer without any would be a number in the file
        assert claim.not_reproducible or " from " in " ".join(claim.ours.split()), name


@pytest.mark.parametrize(
    ("entry", "told"),
    [
        ('published = 1.0\nours = "select 1"', "without a tolerance"),
        ('published = "yes"\ntolerance = 0.1\nours = "select 1"', "no tolerance"),
        ('published = "yes"', "no query"),
        ('published = "yes"\nours = "select 1"\nreason = "misprint"', "does not explain"),
        ('published = "yes"\nours = "select 1"\nreason = "weather"', "Invalid enum value"),
    ],
)
def test_a_claim_that_lacks_something_is_refused_in_one_line(tmp_path, entry, told):
    file = tmp_path / "claims.toml"
    file.write_text(f'[one]\nsource = "here"\nstatement = "so"\n{entry}\n')
    with pytest.raises(DeclarationError, match=told) as caught:
        read_claims(file)
    assert "\n" not in str(caught.value)


def test_verdicts_at_the_edge_of_the_tolerance():
    claim = Claim(source="", statement="", published=2.0, ours="select", tolerance=0.5)
    assert verdict(claim, 2.5) == "reproduced"
    assert verdict(claim, math.nextafter(2.5, 3)) == "differs"
    assert verdict(claim, None) == "differs"
    impossible = Claim(source="", statement="", published="x", not_reproducible="no scale")
    assert verdict(impossible, "x") == "not_reproducible"


def test_summary_tells_known_from_unexplained_differences():
    rows = [
        {"verdict": "reproduced", "reason": None},
        {"verdict": "differs", "reason": "misprint"},
        {"verdict": "differs", "reason": "unexplained"},
        {"verdict": "not_reproducible", "reason": None},
    ]
    told = "1 of 4 reproduced; 2 differ, 1 of them for a known reason (1 misprint); 1 UNEXPLAINED; 1 not reproducible"
    assert summary(rows) == told


def test_rows_say_what_is_known_about_a_difference(quickstart):
    done = quickstart.vines("check", "quickstart", "--json", check=False)
    rows = {row["id"]: row for row in json.loads(done.stdout)}
    read_off = rows["fig4_pair_turns_real"]
    assert (read_off["verdict"], read_off["reason"]) == ("differs", "read off a plot")
    assert abs(read_off["our_value"] - read_off["published_value"]) > read_off["tolerance"]
    assert rows["fig2_g"]["detail"] == "2:2/2T by definition"
    shown = quickstart.vines("check", "quickstart", check=False)
    assert shown.returncode == 1
    assert shown.stdout.splitlines()[-1] == "5 of 6 reproduced; 1 differs, for a known reason (1 read off a plot)"


def test_the_page_has_a_row_a_claim(quickstart):
    shown = quickstart.vines("check", "quickstart", "--markdown", check=False).stdout
    rows = json.loads(quickstart.vines("check", "quickstart", "--json", check=False).stdout)
    assert shown.splitlines() == list(page(rows))
    assert sum(line.startswith("| `") for line in shown.splitlines()) == len(rows)


def test_a_query_that_fails_names_its_claim(project):
    (project.root / "pipelines" / "claims.toml").write_text(
        '[one]\nsource = "here"\nstatement = "so"\npublished = "yes"\nours = "select nothing from points"\n'
    )
    (project.root / "pipelines" / "short.toml").write_text(
        'title = "t"\n[stages.run]\nkind = "sweep"\nvary.A = [0.015]\nparams.mu = 0.01\nsettle = 50\n'
        '[stages.checks]\nkind = "check"\nclaims = ["one"]\nneeds = ["run"]\n'
    )
    done = project.vines("run", "short", "--quiet", check=False)
    assert done.returncode == 3
    assert "claim 'one'" in done.stderr


def test_the_page_in_the_docs_has_every_claim():
    told = (REPOSITORY / "docs" / "claims.md").read_text()
    assert {line.split("`")[1] for line in told.splitlines() if line.startswith("| `")} == set(CLAIMS)
