"""Points: zipped axes, carried chains, refinement, shares; ids and values of many at once."""

import itertools
import math
import struct
from fractions import Fraction

import numpy as np
import pytest

from vines.errors import DeclarationError
from vines.pipeline import Shard, load, plan
from vines.pipeline._axes import read_axis
from vines.pipeline._grid import Grid
from vines.pipeline._identity import free_ids, murmur

UP = """
    [stages.up]
    kind = "toy"
    vary.A = { from = 0.1, to = 0.5, count = 5 }
"""
REFINED = UP + '    refine = { on = ["end_x1"], tolerance = 0.01, jump = 0.2 }\n'


def grid_of(lab, text, stage="up"):
    return Grid(load(lab.declare(text), root=lab.folder).stages[stage])


def rows_of(grid):
    columns = grid.columns(range(len(grid)))
    return list(zip(*(columns[name].tolist() for name in grid.names), strict=True))


@pytest.mark.parametrize(
    "form",
    [
        {"from": 0.015, "to": 0.023, "count": 401},
        {"from": 0.1, "to": 100, "count": 37, "log": True},
        [0.3, 0.1, 0.2],
        {"from": -1, "to": 1, "step": 0.1},
        {"from": 0.123456789012345, "to": 0.987654321098765, "count": 1001},
    ],
)
def test_values_of_many_are_those_of_each(form):
    axis = read_axis("A", form, "f", interval=False)
    assert tuple(axis.at(np.arange(axis.count)).tolist()) == axis.values()
    assert all(axis.value(Fraction(i)) == value for i, value in enumerate(axis.values()) if i < axis.count - 1)


def reference(message, seed=0):
    """MurmurHash3_x64_128 as published, byte by byte."""
    mask = 2**64 - 1

    def rotate(x, bits):
        return ((x << bits) | (x >> (64 - bits))) & mask

    def mix(x):
        x = (x ^ x >> 33) * 0xFF51AFD7ED558CCD & mask
        x = (x ^ x >> 33) * 0xC4CEB9FE1A85EC53 & mask
        return x ^ x >> 33

    c1, c2 = 0x87C37B91114253D5, 0x4CF5AD432745937F
    h1 = h2 = seed
    whole = len(message) // 16 * 16
    for i in range(0, whole, 16):
        k1, k2 = struct.unpack("<QQ", message[i : i + 16])
        h1 ^= rotate(k1 * c1 & mask, 31) * c2 & mask
        h1 = ((rotate(h1, 27) + h2) * 5 + 0x52DCE729) & mask
        h2 ^= rotate(k2 * c2 & mask, 33) * c1 & mask
        h2 = ((rotate(h2, 31) + h1) * 5 + 0x38495AB5) & mask
    tail = message[whole:]
    if tail:
        k1 = int.from_bytes(tail[:8], "little")
        k2 = int.from_bytes(tail[8:], "little")
        h2 ^= rotate(k2 * c2 & mask, 33) * c1 & mask
        h1 ^= rotate(k1 * c1 & mask, 31) * c2 & mask
    h1, h2 = h1 ^ len(message), h2 ^ len(message)
    h1 = (h1 + h2) & mask
    h2 = (h2 + h1) & mask
    h1, h2 = mix(h1), mix(h2)
    h1 = (h1 + h2) & mask
    return h1, (h2 + h1) & mask


@pytest.mark.parametrize("words", [1, 2, 3, 5])
def test_the_hash_of_many_is_the_published_one(words):
    values = np.random.default_rng(1).normal(size=(words, 20))
    high, low = murmur([column.view(np.uint64) for column in values])
    for i in range(20):
        assert (int(high[i]), int(low[i])) == reference(values[:, i].tobytes())
    # SMHasher's check of the reference: hashes of keys {}, {0}, {0, 1}, … with seeds 256 - n, hashed again
    keys = b"".join(struct.pack("<QQ", *reference(bytes(range(n)), 256 - n)) for n in range(256))
    assert reference(keys)[0] & 0xFFFFFFFF == 0x6384BA69


def test_both_zeros_are_one_point():
    assert free_ids([np.array([0.0])]).hex() == free_ids([np.array([-0.0])]).hex()


def test_zipped_axes_run_together(lab):
    text = UP.replace("count = 5 }", "count = 3 }\n    vary.mu = [3, 1, 2]\n    zip = ['A', 'mu']")
    assert rows_of(grid_of(lab, text)) == [(0.1, 3.0), (0.3, 1.0), (0.5, 2.0)]
    lab.run(lab.declare(text), jobs=1)
    assert [(row["A"], row["mu"]) for row in lab.rows("up")] == [(0.1, 3.0), (0.3, 1.0), (0.5, 2.0)]


def test_a_falling_range_falls_where_it_is_zipped_and_shares_points_with_the_product(lab, tally):
    path, read = tally
    product = UP.replace("count = 5 }", "count = 3 }\n    vary.mu = { from = 3, to = 1, count = 3 }")
    product += f'    tally = "{path}"\n'
    zipped = product + "    zip = ['A', 'mu']\n"
    assert rows_of(grid_of(lab, zipped)) == [(0.1, 3.0), (0.3, 2.0), (0.5, 1.0)]
    lab.run(lab.declare(product), jobs=1)
    assert len(read()) == 9
    summary = lab.run(lab.declare(zipped), jobs=1)
    assert summary.new == 0
    assert len(lab.rows("up")) == 3


def test_a_chain_may_run_along_zipped_axes(lab):
    text = UP.replace("count = 5 }", "count = 3 }\n    vary.mu = [3, 1, 2]\n    zip = ['A', 'mu']\n    carry = 'A'")
    lab.run(lab.declare(text), jobs=1)
    state, wanted = None, []
    for a in (0.1, 0.3, 0.5):
        state = math.sin(a) + (0.5 * state if state is not None else 0.0)
        wanted.append(state)
    assert [row["end_x1"] for row in lab.rows("up")] == wanted


@pytest.mark.parametrize(
    ("more", "words"),
    [
        ("zip = ['A', 'mju']", "axis 'mju' is not varied: did you mean 'mu'"),
        ("zip = ['A']", "list two or more axes"),
        ("zip = [['A', 'mu'], ['mu', 'A']]", "names an axis twice"),
        ("vary.mu = [1, 2]\n    zip = ['A', 'mu']", "equally many values: A has 5, mu has 2"),
        ("carry = 'mu'\n    zip = ['A', 'mu']", "the values of mu neither rise nor fall throughout"),
        ("refine = { on = ['nam'], tolerance = 1 }", "no column 'nam' to watch: did you mean 'name'"),
        ("refine = { on = ['name'] }", "'tolerance' is missing"),
        ("refine = { on = 'name', tolerance = 1 }", "list columns"),
        ("refine = { on = ['name'], tolerance = 0 }", "tolerance is 0; allowed is a number > 0"),
        ("refine = { on = ['name'], tolerance = 1, most = 0 }", "most is 0"),
        ("refine = { on = ['name'], tolerance = 1, along = 'B' }", "along is 'B'; points are added along"),
        ("refine = { on = ['name'], tolerance = 1, jump = { n = 1 } }", "'n' is not watched"),
        ("refine = { on = ['name'], tolerence = 1 }", "unknown key 'tolerence': did you mean 'tolerance'"),
        ("carry = 'mu'\n    refine = { on = ['name'], tolerance = 1, along = 'A' }", "along the carried axis"),
    ],
)
def test_mistakes_about_points_are_one_line(lab, more, words):
    text = UP + ("    vary.mu = [1, 2, 3, 2, 1]\n" if "vary.mu" not in more and "zip" in more else "")
    text += "    vary.mu = [1, 2]\n" if "carry = 'mu'\n    refine" in more else ""
    with pytest.raises(DeclarationError) as caught:
        load(lab.declare(text + f"    {more}\n"), root=lab.folder)
    assert words in str(caught.value)
    assert "\n" not in str(caught.value)


def test_401_points_to_801_computes_400_and_to_1201_computes_800(lab):
    declared = lab.declare(UP.replace("count = 5", "count = 401").replace("toy", "bare"))
    assert lab.run(declared, jobs=1).new == 401
    assert lab.run(declared, {"stages.up.vary.A.count": 801}, jobs=1).new == 400
    assert lab.run(declared, {"stages.up.vary.A.count": 1201}, jobs=1).new == 800
    assert lab.run(declared, {"stages.up.vary.A": [0.1, 0.1001, 0.5]}, jobs=1).new == 1


@pytest.mark.parametrize("direction", ["up", "down"])
def test_a_carried_sweep_extended_at_its_far_end_computes_only_the_new_points(lab, direction):
    # Two steps of .1 below the near end A is still an amplitude, which is never negative.
    text = UP.replace("from = 0.1, to = 0.5", "from = 0.3, to = 0.7")
    declared = lab.declare(text + f'    carry = {{ axis = "A", direction = "{direction}" }}\n')
    lab.run(declared, jobs=1)
    far = {"up": {"stages.up.vary.A.to": 0.9}, "down": {"stages.up.vary.A.from": 0.1}}[direction]
    assert lab.run(declared, {**far, "stages.up.vary.A.count": 7}, jobs=1).new == 2


def values(lab):
    return [row["A"] for row in lab.rows("up")]


def test_refinement_adds_points_where_a_measure_jumps_down_to_the_tolerance(lab):
    # sin jumps by more than a fifth between neighbours near 0.1 and hardly near 0.5
    lab.run(lab.declare(REFINED), jobs=1)
    found = lab.rows("up")
    for one, other in itertools.pairwise(found):
        change = abs(one["end_x1"] - other["end_x1"]) / max(one["end_x1"], other["end_x1"])
        assert change <= 0.2 or other["A"] - one["A"] <= 0.01
    assert 5 < len(found) < 20
    assert values(lab) == sorted(values(lab))
    assert lab.run(lab.declare(REFINED), jobs=1).new == 0
    again = lab.run(lab.declare(REFINED), {"stages.up.refine.jump": 0.1}, jobs=1)
    assert again.new == again.stages[0].wanted - len(found) > 0


@pytest.mark.parametrize("carry", ["", "    carry = 'A'\n", "    carry = { axis = 'A', direction = 'down' }\n"])
def test_an_interrupted_refinement_goes_on_and_ends_with_the_same_bytes(lab, tally, carry):
    path, read = tally
    declared = lab.declare(REFINED.replace('"toy"', f'"toy"\n    tally = "{path}"') + carry)
    total = lab.run(declared, jobs=1).new
    assert sum(read().values()) == total > 5
    whole = lab.bytes_of("up")

    def stop(event):
        if event.what == "progress" and event.wanted > 5:
            raise KeyboardInterrupt

    from vines.pipeline import run_pipeline
    from vines.store import Store

    lab.store = Store(lab.folder / "again")
    with pytest.raises(KeyboardInterrupt):
        run_pipeline(load(declared, root=lab.folder), lab.store, jobs=1, report=stop)
    before = sum(read().values())
    assert 5 < before < total
    assert "or some of the refinement" in plan(load(declared, root=lab.folder), lab.store)[0].reason
    lab.run(declared, jobs=1)
    assert sum(read().values()) == total - before
    assert lab.bytes_of("up") == whole


def test_a_carried_point_that_is_added_starts_from_the_neighbour_before_it(lab):
    lab.run(lab.declare(REFINED + "    carry = 'A'\n"), jobs=1)
    found = {row["A"]: row["end_x1"] for row in lab.rows("up")}
    assert found[0.15] == math.sin(0.15) + 0.5 * found[0.1]


def test_refinement_stops_at_its_limit_and_says_so(lab):
    summary = lab.run(lab.declare(REFINED.replace("tolerance = 0.01", "tolerance = 1e-6, most = 3")), jobs=1)
    assert "refine stopped at" in summary.stages[0].remark
    assert summary.stages[0].wanted <= 8
    assert "refine stopped" in plan(load(lab.folder / "pipelines" / "toys.toml", root=lab.folder), lab.store)[0].remark


def test_refinement_goes_along_one_of_several_axes(lab):
    text = REFINED.replace("jump = 0.2", 'jump = 0.2, along = "A"') + "    vary.mu = [1, 2]\n"
    lab.run(lab.declare(text), jobs=1)
    found = lab.rows("up")
    lines = [[row["A"] for row in found if row["mu"] == mu] for mu in (1.0, 2.0)]
    assert lines[0] == lines[1]
    assert len(lines[0]) > 5
    assert [(row["A"], row["mu"]) for row in found] == sorted((row["A"], row["mu"]) for row in found)


def test_shares_are_disjoint_complete_and_even():
    for total in (1, 5, 41, 1000, 100_001):
        shares = [Shard(i, 4).mine(total) for i in (1, 2, 3, 4)]
        assert (np.sum(shares, axis=0) == 1).all()
        counts = [int(share.sum()) for share in shares]
        assert max(counts) - min(counts) <= max(1, total // 64)
    for text in ("0/4", "5/4", "1", "1/0", "a/b"):
        with pytest.raises(DeclarationError, match="is not i/n"):
            Shard.read(text)


@pytest.mark.parametrize(
    ("values", "carry", "order"),
    [
        ("{ from = 0.5, to = 0.1, count = 3 }", "'A'", [0.5, 0.3, 0.1]),
        ("{ from = 0.1, to = 0.5, count = 3 }", "'A'", [0.1, 0.3, 0.5]),
        ("[0.5, 0.3, 0.1]", "'A'", [0.5, 0.3, 0.1]),
        ("[0.1, 0.3, 0.5]", "{ axis = 'A', direction = 'down' }", [0.5, 0.3, 0.1]),
        ("{ from = 0.5, to = 0.1, count = 3 }", "{ axis = 'A', direction = 'up' }", [0.1, 0.3, 0.5]),
    ],
)
def test_a_chain_runs_as_its_values_are_declared(lab, values, carry, order):
    declared = lab.declare(f'[stages.up]\nkind = "toy"\nvary.A = {values}\ncarry = {carry}\n')
    lab.run(declared, jobs=1)
    state, wanted = None, {}
    for a in order:
        state = wanted[a] = math.sin(a) + (0.5 * state if state is not None else 0.0)
    rows = lab.rows("up")
    assert [row["A"] for row in rows] == [0.1, 0.3, 0.5]
    assert {row["A"]: row["end_x1"] for row in rows} == wanted


def test_a_list_without_an_order_is_refused_where_states_are_carried(lab):
    declared = lab.declare('[stages.up]\nkind = "toy"\nvary.A = [1.02, 1.0, 1.01]\ncarry = "A"\n')
    with pytest.raises(
        DeclarationError, match="the values of A neither rise nor fall throughout, and a chain runs up or"
    ):
        load(declared, root=lab.folder)


def test_a_full_disk_is_no_property_of_a_point(lab):
    """No point is stored as failed for what the machine lacks: it ends the run, and the next one computes it."""
    full = lab.declare(UP.replace('"toy"', '"toy"\n    tally = "/dev/full"'))
    for jobs in (1, 2):
        with pytest.raises(OSError, match="No space left on device"):
            lab.run(full, jobs=jobs)
        assert not [*lab.store.pools.glob("*/0*")]
        assert lab.store.pins("toys") == {}
