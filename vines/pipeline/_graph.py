"""A pipeline as a Mermaid flowchart, which GitHub and most editors draw."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from vines.pipeline._declaration import Pipeline
from vines.pipeline._plan import StagePlan

__all__ = ["mermaid", "mermaid_of_all"]

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
    return "\n".join(["flowchart LR", *_boxes(pipeline, plans), *_classes(plans.values())])


def mermaid_of_all(parts: Sequence[tuple[Pipeline, Mapping[str, StagePlan]]]) -> str:
    """Return several pipelines, each in a frame of its own; see :func:`mermaid`."""
    lines = ["flowchart LR"]
    for pipeline, plans in parts:
        frame = f"pipeline_{pipeline.name}"
        title = f"{pipeline.name}: {pipeline.title}".replace('"', "'")
        lines.append(f'    subgraph {frame}["{title}"]')
        lines += _boxes(pipeline, plans, f"{pipeline.name}_")
        lines.append("    end")
    return "\n".join([*lines, *_classes(plan for _, plans in parts for plan in plans.values())])


def _boxes(pipeline: Pipeline, plans: Mapping[str, StagePlan], prefix: str = "") -> list[str]:
    def node(name: str) -> str:
        # no word of Mermaid, such as "end"
        return f"stage_{prefix}{name}"

    lines = []
    for name in pipeline.order:
        plan = plans[name]
        points = f"{plan.done}/{plan.wanted} points" if pipeline.stages[name].kind.shape == "points" else ""
        failed = f"{plan.failed} failed" if plan.failed else ""
        text = "<br/>".join(filter(None, [f"<b>{name}</b>", plan.kind, points, failed, plan.state.replace("_", " ")]))
        lines.append(f'    {node(name)}["{text}"]:::{plan.state}')
    for name in pipeline.order:
        stage = pipeline.stages[name]
        lines += [f"    {node(need)} --> {node(name)}" for need in stage.needs]
        if stage.carry is not None and stage.carry.stage:
            at = ", ".join(f"{axis} = {value:.12g}" for axis, value in stage.carry.at) or "its end"
            lines.append(f'    {node(stage.carry.stage)} -. "{at}" .-> {node(name)}')
    return lines


def _classes(plans: Iterable[StagePlan]) -> list[str]:
    used = {plan.state for plan in plans}
    return [f"    classDef {state} {style}" for state, style in _COLOURS.items() if state in used]
