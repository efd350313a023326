"""What there is to do: for each stage what is wanted, what is there, and why it is stale."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any, Literal

from vines.errors import DamageError
from vines.pipeline._code import CodeDigests
from vines.pipeline._declaration import Pipeline, Stage
from vines.pipeline._grid import Grid
from vines.pipeline._ingredients import Ingredients, gather, what_changed
from vines.store import Store, canonical, versions

if TYPE_CHECKING:
    from vines.pipeline._refined import Refined

__all__ = ["Planner", "Prepared", "StagePlan", "code_digests", "other_versions", "plan", "pool_keys"]


@dataclass(frozen=True, slots=True)
class StagePlan:
    """What a run would do with a stage.

    Attributes
    ----------
    name, kind : str
        The stage and its kind.
    state : {"up_to_date", "stale", "missing", "never"}
        The pinned result is what is asked for; it is another; its folder is gone; the stage was never finished.
    reason : str
        Why, with changed values before → after; empty if up to date.
    wanted, done, failed : int
        Points that are asked for; those that need not be computed; those among them that are rows with status
        ``failed``. A stage of the whole shape counts as one point.
    key : str
        Key of the result; where points are still to be computed, the key if none of them fails.
    versions : str
        Which packages the result was computed with, where they are others than now; empty otherwise.
    remark : str
        Why a refinement ended early; empty otherwise.
    kernels : tuple of str
        Kinds of tasks whose compiled kernels the stage would ask for, as its kind says.
    """

    name: str
    kind: str
    state: Literal["up_to_date", "stale", "missing", "never"]
    reason: str
    wanted: int
    done: int
    failed: int
    key: str
    versions: str = ""
    remark: str = ""
    kernels: tuple[str, ...] = ()


@dataclass
class Prepared:
    """A stage with its ingredients and points, ready to be planned or computed."""

    stage: Stage
    ingredients: Ingredients
    grid: Grid
    pin: dict[str, Any]
    damaged: dict[str, str] = field(default_factory=dict)
    """Parts of its pool that are not what was written, and why."""

    @property
    def origin(self) -> str:
        """Identity of the point of another stage that starts its chains; empty if there is none."""
        return self.grid.origin

    @cached_property
    def pool_key(self) -> str:
        """Key of its pool of points."""
        return self.ingredients.pool_key

    @cached_property
    def request(self) -> str:
        """Key of what is asked for."""
        return self.ingredients.request

    def result_key(self, grid: Grid | Refined | None = None, failed: Iterable[str] = ()) -> str:
        """Return the key of the result.

        Parameters
        ----------
        grid : Grid or Refined, optional
            All its points, in their order; those declared if left out.
        failed : iterable of str
            Those of them that failed.
        """
        if self.stage.kind.shape == "whole":
            return self.request
        head = canonical({"pool": self.pool_key, "failed": sorted(failed)})
        digest = hashlib.sha256(head.encode())
        digest.update((self.grid if grid is None else grid).ids.raw.tobytes())
        return digest.hexdigest()


class Planner:
    """Plans stages one after the other; each needs the keys of those before it.

    Parameters
    ----------
    pipeline : Pipeline
        The declared pipeline.
    store : Store
        Where results are kept.
    code : CodeDigests, optional
        The look at the sources that it shares with others; one of its own if left out.
    """

    def __init__(self, pipeline: Pipeline, store: Store, code: CodeDigests | None = None) -> None:
        self.pipeline = pipeline
        self.store = store
        self.pins, self.damage = _pins(pipeline, store)
        self.keys: dict[str, str] = {}
        self.code = code_digests(store) if code is None else code
        self._prepared: dict[str, Prepared] = {}
        self._grids: dict[tuple[str, str], Grid] = {}

    def afresh(self) -> Planner:
        """Return a planner that looks at the store and the sources again, and keeps what depends on neither."""
        new = Planner(self.pipeline, self.store)
        new._grids = self._grids
        return new

    def prepare(self, name: str) -> Prepared:
        """Return a stage with its ingredients; the stages before it must have been planned."""
        if name not in self._prepared:
            stage = self.pipeline.stages[name]
            origin = self._origin(stage)
            ingredients = gather(stage, self.keys, origin, self.code, self.pipeline.root)
            grid = self._grids.setdefault((name, origin), Grid(stage, origin))
            self._prepared[name] = Prepared(stage, ingredients, grid, self.pins.get(name, {}))
        return self._prepared[name]

    def plan(self, name: str) -> StagePlan:
        """Return the plan of a stage and remember the key of its result for those after it."""
        prepared = self.prepare(name)
        stage, pin = prepared.stage, prepared.pin
        if pin.get("request") == prepared.request and self.store.has(pin["result"]):
            self.keys[name] = pin["result"]
            counts = (pin["points"], pin["points"], pin["failed"])
            notes = (other_versions(pin.get("versions", {})), pin.get("remark", ""))
            return StagePlan(name, stage.kind.name, "up_to_date", "", *counts, pin["result"], *notes)
        if stage.kind.shape == "whole":
            key = prepared.result_key()
            wanted, done, failed = 1, int(self.store.has(key)), 0
        else:
            key, wanted, done, failed = self._points(prepared)
        self.keys[name] = key
        state, reason = self._state(prepared, wanted, done)
        then = other_versions(pin.get("versions", {})) if pin else ""
        needed = stage.kind.kernels
        if not isinstance(needed, tuple):
            needed = needed(stage.options, stage.carry is not None)
        return StagePlan(name, stage.kind.name, state, reason, wanted, done, failed, key, then, kernels=needed)

    def set_key(self, name: str, key: str) -> None:
        """Say which key the result of a stage has now that it was computed."""
        self.keys[name] = key

    def _points(self, prepared: Prepared) -> tuple[str, int, int, int]:
        grid = prepared.grid
        # the key of the pool, the ids, and numpy for them, are only needed where something is there
        if not self.store.has_pools() or not (pool := self.store.pool(prepared.pool_key)).names():
            return prepared.request, len(grid), 0, 0
        located = pool.locate(grid.ids)
        prepared.damaged = pool.damaged
        failed = grid.ids.take(located.failed).hex()
        return prepared.result_key(failed=failed), len(grid), int((located.part >= 0).sum()), len(failed)

    def _state(self, prepared: Prepared, wanted: int, done: int) -> tuple[Literal["stale", "missing", "never"], str]:
        left = f"{wanted - done} of {wanted} points to compute" if wanted > 1 else "to compute"
        if prepared.stage.refine is not None:
            left += ", and those of the refinement" if done < wanted else ", or some of the refinement"
        elif done == wanted:
            left = "everything is computed, the result has to be put together"
        if prepared.damaged:
            left += f" ({next(iter(prepared.damaged.values()))})"
        pin = prepared.pin
        if not pin:
            return "never", f"{self.damage or 'never finished'}; {left}"
        changed = what_changed(pin.get("ingredients", {}), prepared.ingredients.form)
        problem = "" if changed else self.store.problem(pin["result"])
        if problem:
            return "missing", f"result {pin['result'][:12]}: {problem}; {left}"
        return "stale", f"{changed or 'the form of the key changed'}; {left}"

    def _origin(self, stage: Stage) -> str:
        """Return the identity of the point that starts the chains of a stage, if another stage gives it."""
        if stage.carry is None or stage.carry.stage is None:
            return ""
        source = self.prepare(stage.carry.stage)
        return f"{source.pool_key}/{source.grid.identity(dict(stage.carry.at))}"


def _pins(pipeline: Pipeline, store: Store) -> tuple[dict[str, dict[str, Any]], str]:
    """Return the pins of a pipeline, and why there are none if their file is damaged."""
    try:
        return store.pins(pipeline.name), ""
    except DamageError as error:
        return {}, str(error)


def code_digests(store: Store) -> CodeDigests:
    """Return a look at the sources, with a cache in the store if there is one; for all plans that are made together."""
    return CodeDigests(store.cache / "code.json" if store.data.is_dir() else None)


def pool_keys(pipeline: Pipeline, store: Store, code: CodeDigests | None = None) -> set[str]:
    """Return the keys of the pools that a pipeline asks for as it is declared."""
    planner = Planner(pipeline, store, code)
    for name in pipeline.order:
        planner.plan(name)
    stages = [planner.prepare(name) for name in pipeline.order]
    return {each.pool_key for each in stages if each.stage.kind.shape == "points"}


def other_versions(then: Mapping[str, str]) -> str:
    """Return in words which packages were others when something was computed; vines itself is told by its code.

    Examples
    --------
    >>> other_versions({"numpy": "0.1"})[:20]
    'numpy 0.1 then, now '
    """
    now = versions()
    names = [name for name in sorted(then) if name != "vines" and then[name] != now.get(name)]
    return "; ".join(f"{name} {then[name]} then, now {now.get(name, 'not installed')}" for name in names)


def plan(
    pipeline: Pipeline, store: Store, stages: Iterable[str] | None = None, *, code: CodeDigests | None = None
) -> list[StagePlan]:
    """Return what a run would do, stage by stage in the order of the run. Computes and writes nothing of value.

    Parameters
    ----------
    pipeline : Pipeline
        The declared pipeline.
    store : Store
        Where results are kept.
    stages : iterable of str, optional
        Only these and what they need.
    code : CodeDigests, optional
        The look at the sources that plans made together share.

    Raises
    ------
    UnknownNameError
        If there is no such stage.
    FileMissingError
        If a file that a stage needs is missing.
    """
    planner = Planner(pipeline, store, code)
    plans = [planner.plan(name) for name in pipeline.select(stages)]
    planner.code.save()
    return plans
