"""Body of the kind ``check``: published values against the tables of other stages."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from vines.catalogue import connect_tables
from vines.errors import DeclarationError, QueryError, nearest
from vines.pipeline import Batch, Input, WholeJob
from vines.stages.bodies._claims import Claim, read_claims

if TYPE_CHECKING:
    from vines.stages.kinds.check import CheckOptions

__all__ = ["UNEXPLAINED", "compute", "verdict"]


NO_VALUE = "no value of ours: the query of the claim gave no row"
UNEXPLAINED = "unexplained"
"""Reason of a difference that the claim does not know of."""


def compute(job: WholeJob[CheckOptions]) -> Batch:
    """Compare each claim that the stage names with the tables of the stages it needs."""
    options = job.options
    claims = read_claims(job.files[0])
    for name in options.claims:
        if name not in claims:
            raise DeclarationError(f"unknown claim {name!r} in {job.files[0].name}: {nearest(name, claims)}")
    with connect_tables(_by_table(job.inputs)) as query:
        rows = [_row(name, claims[name], query) for name in options.claims]
    return Batch(tables={"checks": rows})


def _by_table(inputs: dict[str, Input]) -> dict[str, dict[str, Any]]:
    """Return the needed tables as {table: {stage: Arrow table}}."""
    found: dict[str, dict[str, Any]] = {}
    for stage in inputs.values():
        for table in stage.tables:
            found.setdefault(table, {})[stage.name] = stage.table(table)
    return found


def _row(name: str, claim: Claim, query: Any) -> dict[str, Any]:
    value, detail = _answer(name, claim.ours, query) if claim.ours.strip() else (None, None)
    number = isinstance(claim.published, int | float)
    found = verdict(claim, value)
    return {
        "id": name,
        "source": claim.source,
        "statement": claim.statement,
        "published": claim.printed or (f"{claim.published:.10g}" if number else claim.published),
        "ours": None if value is None else (f"{value:.7g}" if isinstance(value, float) else str(value)),
        "detail": detail,
        "published_value": float(claim.published) if number else None,
        "our_value": float(value) if number and value is not None else None,
        "tolerance": claim.tolerance,
        "verdict": found,
        "reason": (claim.reason or UNEXPLAINED) if found == "differs" else None,
        "remark": claim.not_reproducible or (claim.remark if value is not None else NO_VALUE),
    }


def _answer(name: str, sql: str, query: Any) -> tuple[Any, str | None]:
    """Return the value that the query of a claim gives and the numbers behind it; nothing if it gives no row."""
    try:
        rows: list[tuple[Any, ...]] = query(sql)
    except QueryError as error:
        raise QueryError(f"claim {name!r}: {error}") from None
    if len(rows) > 1 or (rows and len(rows[0]) > 2):
        raise DeclarationError(
            f"claim {name!r}: its query gives {len(rows)} rows of {len(rows[0])} columns; it has to give one row, the "
            "value and perhaps a text behind it (add a limit or an aggregate)"
        )
    if not rows:
        return None, None
    value, detail = (*rows[0], None)[:2]
    return value, None if detail is None else str(detail)


def verdict(claim: Claim, value: Any) -> str:
    """Return ``reproduced``, ``differs`` or ``not_reproducible``.

    Parameters
    ----------
    claim : Claim
        What was published.
    value : float, str or None
        Ours; ``None`` where the tables have none, which counts as a difference.

    Examples
    --------
    >>> claim = Claim(source="", statement="", published=0.018, ours="", tolerance=0.0005)
    >>> verdict(claim, 0.01803), verdict(claim, 0.019), verdict(claim, None)
    ('reproduced', 'differs', 'differs')
    """
    if claim.not_reproducible:
        return "not_reproducible"
    if value is None:
        return "differs"
    if isinstance(claim.published, str):
        return "reproduced" if value == claim.published else "differs"
    return "reproduced" if abs(float(value) - claim.published) <= (claim.tolerance or 0.0) else "differs"
