"""Plans: what is stale and why, from the code as well as from the declaration; light and quick."""

import subprocess
import sys
import time

import pytest

from vines.errors import DeclarationError
from vines.pipeline import load, plan
from vines.pipeline._code import CodeDigests

TOYS = """
    [stages.up]
    kind = "toy"
    gain = 1
    vary.A = { from = 0.1, to = 0.5, count = 5 }
    [stages.total]
    kind = "total"
    needs = ["up"]
    [stages.lone]
    kind = "total"
"""


def states(lab, text=TOYS, overrides=None):
    pipeline = load(lab.declare(text), overrides, root=lab.folder)
    return {each.name: each for each in plan(pipeline, lab.store)}


def test_a_plan_says_never_up_to_date_missing(lab):
    assert {each.state for each in states(lab).values()} == {"never"}
    assert not lab.store.data.exists()
    lab.run(lab.declare(TOYS), jobs=1)
    assert {each.state for each in states(lab).values()} == {"up_to_date"}
    folder = lab.folder_of("up")
    folder.rename(lab.folder / "away")
    up = states(lab)["up"]
    assert (up.state, up.wanted, up.done) == ("missing", 5, 5)
    assert up.reason.endswith("everything is computed, the result has to be put together")


def test_the_reason_shows_the_value_before_and_after(lab):
    lab.run(lab.declare(TOYS), jobs=1)
    now = states(lab, overrides={"stages.up.gain": 2, "stages.up.vary.A.count": 9})
    assert now["up"].state == "stale"
    assert now["up"].reason.startswith("gain 1 → 2; vary.A 5 values from 0.1 to 0.5 → 9 values from 0.1 to 0.5")
    assert now["total"].reason.startswith("input up changed")
    assert now["lone"].state == "up_to_date"


def test_numbers_written_otherwise_are_the_same(lab):
    lab.run(lab.declare(TOYS), jobs=1)
    same = TOYS.replace("gain = 1", "gain = 1.0\n    steps = 1\n    params.mu = 0.10").replace("0.5,", "0.50,")
    assert states(lab, same)["up"].state == "up_to_date"


def test_going_back_to_an_earlier_declaration_needs_no_computing(lab):
    declared = lab.declare(TOYS)
    lab.run(declared, jobs=1)
    lab.run(declared, {"stages.up.gain": 2}, jobs=1)
    assert states(lab)["up"].done == 5
    assert lab.run(declared, jobs=1).new == 0


@pytest.mark.parametrize(
    ("old", "new", "stale"),
    [
        ("gain * math.sin(a)", "gain * math.cos(a)", {"up", "total"}),
        ("# exactly", "# quite exactly", set()),
        ("Return the value.", "Return another value.", set()),
    ],
)
def test_an_edited_helper_makes_the_right_stages_stale_a_comment_none(lab, old, new, stale):
    # both bodies are in one module, so tell them apart: the sum gets one of its own
    body = (lab.package / "bodies.py").read_text()
    lab.source("sums", body.replace("from toylab.law import law", ""))
    text = TOYS.replace('"total"', '"own"')
    from vines.pipeline import Kind, kind, register

    fields = {name: getattr(kind("total"), name) for name in Kind.__dataclass_fields__}
    register(Kind(**{**fields, "name": "own", "body": "toylab.sums:whole"}))
    lab.run(lab.declare(text), jobs=1)
    law = (lab.package / "law.py").read_text()
    assert old in law
    lab.source("law", law.replace(old, new))
    now = states(lab, text)
    assert {name for name, each in now.items() if each.state == "stale"} == stale
    if stale:
        assert now["up"].reason.startswith("code changed: toylab.law;")


def modules(lab, **sources):
    for name, text in sources.items():
        lab.source(name, text)
    return set(CodeDigests().modules("toylab.start:compute"))


def test_the_closure_follows_reexports_to_the_defining_module(lab):
    (lab.package / "room").mkdir()
    lab.source("room/__init__", "from toylab.room._one import one\nfrom toylab.room._two import two\n")
    lab.source("room/_one", "def one(): return 1\n")
    lab.source("room/_two", "def two(): return 2\n")
    found = modules(lab, start="from toylab.room import one\n")
    assert found == {"toylab.start", "toylab.room._one"}
    lazy = '_HOME = {"one": "toylab.room._one", "two": "toylab.room._two"}\n__all__ = sorted(_HOME)\n\n\n'
    lab.source("room/__init__", lazy + "def __getattr__(name):\n    return name\n")
    assert modules(lab) == {"toylab.start", "toylab.room._one"}
    lab.source("room/__init__", "from ._one import one\nLEVEL = compute()\n")
    assert modules(lab) == {"toylab.start", "toylab.room", "toylab.room._one"}


def test_the_closure_follows_the_stub_of_a_lazy_package(lab):
    (lab.package / "room").mkdir()
    attach = "import lazy_loader\n__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)\n"
    lab.source("room/__init__", attach)
    stub = lab.package / "room" / "__init__.pyi"
    stub.write_text("from ._one import one as one\nfrom ._two import two as deux\nfrom . import _three as _three\n")
    for name in ("one", "two", "three"):
        lab.source(f"room/_{name}", f"def {name}(): return 1\n")
    assert modules(lab, start="from toylab.room import one\n") == {"toylab.start", "toylab.room._one"}
    assert modules(lab, start="from toylab.room import deux\n") == {"toylab.start", "toylab.room._two"}
    assert modules(lab, start="from toylab.room import _three\n") == {"toylab.start", "toylab.room._three"}
    before = CodeDigests().digest("toylab.start:compute")
    stub.write_text(stub.read_text() + "from ._one import one as more\n")
    assert CodeDigests().digest("toylab.start:compute") == before
    lab.source("room/_three", "def three(): return 3\n")
    assert CodeDigests().digest("toylab.start:compute") != before
    stub.unlink()
    with pytest.raises(DeclarationError, match="stub of a lazy package is missing"):
        modules(lab)


def test_a_changed_stub_is_seen_through_the_cache(lab):
    import os

    (lab.package / "room").mkdir()
    attach = "import lazy_loader\n__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)\n"
    lab.source("room/__init__", attach)
    lab.source("room/_one", "def one(): return 1\n")
    lab.source("room/_two", "def one(): return 2\n")
    lab.source("start", "from toylab.room import one\n")
    stub, cache = lab.package / "room" / "__init__.pyi", lab.folder / "code.json"
    for age, home in ((100, "_one"), (50, "_two")):
        stub.write_text(f"from .{home} import one as one\n")
        for path in lab.package.rglob("*.py*"):
            os.utime(path, (time.time() - age,) * 2 if path == stub else (1e9, 1e9))
        look = CodeDigests(cache)
        assert set(look.modules("toylab.start:compute")) == {"toylab.start", f"toylab.room.{home}"}
        look.save()


def test_the_closure_follows_lazy_and_whole_imports_but_not_those_for_checkers(lab):
    start = (
        "from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n    from toylab.law import law\n\n\n"
        "def compute(job):\n    import toylab.deep as deep\n    from . import other\n    return deep, other\n"
    )
    found = modules(lab, start=start, deep="from vines.model import Params\n", other="import math\n")
    names = ("_conversion", "_declared", "_expression", "_letters", "_parameters", "_params", "_system", "_vi_nes")
    model = {f"vines.model.{name}" for name in names}
    assert found == {"toylab.start", "toylab.deep", "toylab.other", "vines.bounds", *model}


def test_cached_digests_are_used_and_a_change_is_seen(lab):
    import os

    cache = lab.folder / "code.json"
    old = time.time() - 100
    for path in lab.package.glob("*.py"):
        os.utime(path, (old, old))
    first = CodeDigests(cache)
    digest = first.digest("toylab.bodies:points")
    first.save()
    assert cache.exists()
    second = CodeDigests(cache)
    assert second.digest("toylab.bodies:points") == digest
    assert not second._changed
    lab.source("law", "def law(a, gain):\n    return a\n")
    assert CodeDigests(cache).digest("toylab.bodies:points") != digest
    cache.write_text("damaged")
    assert CodeDigests(cache).modules("toylab.bodies:points")


QUICK = """
import sys
from pathlib import Path
sys.path[:0] = [sys.argv[1], sys.argv[3]]
from lab import Lab
from vines.pipeline import load, plan
from vines.store import Store
lab = object.__new__(Lab)
lab.folder = Path(sys.argv[2])
lab.register()
pipeline = load(lab.folder / "pipelines" / "toys.toml", root=lab.folder)
states = {each.state for each in plan(pipeline, Store(lab.folder / "data"))}
heavy = {"pyarrow", "numpy", "numba", "rerun", "matplotlib", "duckdb", "filelock"} & set(sys.modules)
print(states, heavy)
"""


def test_a_plan_loads_no_heavy_package(lab):
    from pathlib import Path

    text = TOYS.replace("count = 5", "count = 401")
    lab.run(lab.declare(text), jobs=1)
    command = [sys.executable, "-c", QUICK, str(lab.package.parent), str(lab.folder), str(Path(__file__).parent)]
    out = subprocess.run(command, capture_output=True, text=True, check=True)
    assert out.stdout == "{'up_to_date'} set()\n"
