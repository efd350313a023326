"""A pipeline as a Mermaid flowchart, which GitHub and most editors draw."""

from __future__ import annotations

from collections.abc import Mapping

from vines.pipeline._declaration import Pipeline
from vines.pipeline._plan import StagePlan

__all__ = ["mermaid"]

_COLOURS = {
    "up_to_date": "fill:#e3f4e3,stroke:#3a7d3a",
    "stale": "fill:#fdf1d6,stroke:#a97b16",
    "missing": "fill:#fbe3e1,stroke:#a33a32",
    "never": "fill:#f2f2f2,stroke:#777",
}


def mermaid(pipeline: Pipeline, plans: Mapping[str, StagePlan]) -> str:
    """Return the stages as boxes and what they need as arrows, dashed where only a start state is taken.

    Parameters
    ----------
    pipeline : Pipeline
        The pipeline.
    plans : mapping of str to StagePlan
        Where each stage stands; it colours the boxes.

    Returns
    -------
    str
        Mermaid source.
    """
    lines = ["flowchart LR"]
    for name in pipeline.order:
        plan = plans[name]
        points = f"{plan.done}/{plan.wanted} points" if pipeline.stages[name].kind.shape == "points" else ""
        failed = f"{plan.failed} failed" if plan.failed else ""
        text = "<br/>".join(filter(None, [f"<b>{name}</b>", plan.kind, points, failed, plan.state.replace("_", " ")]))
        lines.append(f'    {_node(name)}["{text}"]:::{plan.state}')
    for name in pipeline.order:
        stage = pipeline.stages[name]
        lines += [f"    {_node(need)} --> {_node(name)}" for need in stage.needs]
        if stage.carry is not None and stage.carry.stage:
            at = ", ".join(f"{axis} = {value:.12g}" for axis, value in stage.carry.at) or "its end"
            lines.append(f'    {_node(stage.carry.stage)} -. "{at}" .-> {_node(name)}')
    used = {plan.state for plan in plans.values()}
    lines += [f"    classDef {state} {style}" for state, style in _COLOURS.items() if state in used]
    return "\n".join(lines)


def _node(name: str) -> str:
    """Return an identifier that is no word of Mermaid, such as ``end``."""
    return f"stage_{name}"
