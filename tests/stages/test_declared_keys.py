"""Shipped pipelines are declared as before there were several systems: the parts of their keys, and all ids of points.

The list beside this file was made with the version before ``schemas/systems``, by what `declared` does. Digests of
code, tables and files are left out: they change with every version.
"""

import hashlib
import json
from pathlib import Path

from vines.pipeline import load
from vines.pipeline._grid import Grid
from vines.pipeline._ingredients import gather
from vines.places import shipped
from vines.stages.kinds._register import register_kinds
from vines.store import key_of

LIST = Path(__file__).with_name("declared_before_systems.json")


class NoCode:
    def digest(self, *bodies):
        return ""

    def modules_of_all(self, bodies):
        return {}


def declared(stage, root):
    form = gather(stage, {need: need for need in stage.needs}, "", NoCode(), root).form
    plain = {name: part for name, part in form.items() if name not in ("tables", "files", "messages", "code")}
    ids = hashlib.sha256(Grid(stage).ids.raw.tobytes()).hexdigest() if stage.kind.shape == "points" else ""
    return key_of([plain, ids])[:16]


def test_no_key_and_no_id_of_a_shipped_pipeline_has_changed():
    register_kinds()
    before = json.loads(LIST.read_text("utf-8"))
    folder = shipped("pipelines")
    for pipeline in sorted({name.partition(".")[0] for name in before}):
        for name, stage in load(folder / f"{pipeline}.toml", root=folder.parent).stages.items():
            if f"{pipeline}.{name}" in before:
                assert declared(stage, folder.parent) == before[f"{pipeline}.{name}"], f"{pipeline}.{name}"
