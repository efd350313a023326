"""What to do about a result that is asked for and declared, but not computed."""

from __future__ import annotations

from vines.errors import VinesError
from vines.pipeline import available
from vines.stages.api._home import Home
from vines.stages.api._parts import load_parts

__all__ = ["uncomputed"]


def uncomputed(name: str, study: Home) -> str:
    """Return the line that says how a result comes about; empty if it is there, or nothing declares it.

    Parameters
    ----------
    name : str
        ``<pipeline>``, ``<pipeline>.<stage>``, or what has more behind either.
    study : Home
        Whose pipelines and results.
    """
    pipeline, _, more = name.partition("/")[0].partition(".")
    stage = more.partition(".")[0]
    pins = study.store.pins(pipeline) if pipeline in available(study.root) else None
    if pins is None or stage in pins or (pins and not stage):
        return ""
    if not stage:
        return f"{pipeline} is declared but not computed; 'vines run {pipeline}' does it"
    try:
        stages = {each for part in load_parts(pipeline, study=study) for each in part.pipeline.stages}
    except VinesError:
        return ""
    if stage not in stages:
        return ""
    return f"{pipeline}.{stage} is declared but not computed; 'vines run {pipeline} {stage}' does it"
