"""The kind `atlas`: lines in parallel, orbits once each, linked to their branches."""

import numpy as np
import pytest

import vines
from vines.model import Params
from vines.orbits import all_orbits
from vines.stages import run, verify

SMALL = """
title = "small"
[stages.lines]
kind = "atlas"
length = 3
amplitude = { from = 0.018, to = 0.024, count = 4 }
vary.mu = { from = 0.01, to = 0.012, count = 2 }
"""


@pytest.fixture(scope="module")
def small(tmp_path_factory):
    root = tmp_path_factory.mktemp("atlas")
    (root / "pipelines").mkdir()
    (root / "pipelines" / "small.toml").write_text(SMALL)
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("VINES_ROOT", str(root))
        run("small", jobs=1)
        yield root


def test_a_row_a_line_counts_what_was_found(small):
    lines = vines.query("select * from atlas order by mu").to_pylist()
    assert [row["mu"] for row in lines] == [0.01, 0.012]
    for row in lines:
        assert (row["words"], row["incomplete"], row["loose"], row["status"]) == ("LR, LLR", "", 0, "ok")
        for table in ("orbits", "branches", "bifurcations"):
            (counted,) = vines.query(
                f"select count(*) as n from {table} where point_id = '{row['point_id']}'"
            ).to_pylist()
            assert counted["n"] == row[table]


def test_every_admissible_orbit_of_every_word_is_there_once(small):
    for mu in (0.01, 0.012):
        for A in np.linspace(0.018, 0.024, 4).tolist():
            found = vines.query(f"select word, w_dot, orbit_id from orbits where mu = {mu!r} and A = {A!r}").to_pylist()
            assert len({row["orbit_id"] for row in found}) == len(found)
            for word in ("LR", "LLR"):
                ours = [np.sort(np.abs(row["w_dot"])) for row in found if row["word"] == word]
                theirs = [o for o in all_orbits(word, Params(mu=mu, A=A)) if o.admissible]
                assert all(min(abs(np.sort(abs(o.w_dot)) - w).max() for w in ours) < 1e-9 for o in theirs)
                # Of an asymmetric pair with one word one is kept.
                pairs = sum(word == "LR" and not o.symmetric for o in theirs) // 2
                assert len(ours) == len(theirs) - pairs


def test_orbits_of_one_family_share_its_branch(small):
    counted = vines.query(
        "select branch_id, count(distinct o.A) as n, max(b.word) as word, bool_and(o.word = b.word) as same "
        "from orbits as o join branches as b using (branch_id) group by branch_id"
    ).to_pylist()
    assert all(row["same"] for row in counted)
    assert max(row["n"] for row in counted if row["word"] == "LR") == 4
    (loose,) = vines.query("select count(*) as n from orbits where branch_id is null").to_pylist()
    assert loose["n"] == 0


def test_the_pair_is_linked_to_the_family_it_comes_out_of(small):
    rows = vines.query(
        'select child."symmetric" as child, parent."symmetric" as parent from branches as child '
        "join branches as parent on child.parent = parent.branch_id"
    ).to_pylist()
    assert rows == [{"child": False, "parent": True}] * len(rows)
    assert rows


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("length = 3", "length = 13", "length <= 12"),
        ("to = 0.024", "to = 0.01", "from < to"),
        ("length = 3", 'words = ["LX"]', "not a word"),
        ("amplitude", "amplitudes", "amplitude"),
    ],
)
def test_senseless_declarations_are_refused(small, old, new, said):
    file = small / "pipelines" / "wrong.toml"
    file.write_text(SMALL.replace(old, new, 1))
    with pytest.raises(vines.errors.VinesError, match=said):
        run("wrong")
    file.unlink()


def test_what_is_stored_verifies_and_comes_out_again(small):
    found = verify("small", recompute=6)
    assert found.good, [line.first for line in found.lines if not line.good]
    assert {line.group for line in found.lines} >= {"atlas", "orbits", "branches", "bifurcations", "recomputed"}
