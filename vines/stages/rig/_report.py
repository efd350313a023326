"""``vines rig report``: one page about a campaign, from run folders or from a pipeline that went over them."""

from __future__ import annotations

import io
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from vines.errors import RigError, VinesError
from vines.rig import QUANTITIES, Reconstruction, find_runs, read_folder
from vines.rig.ingest import raw_sums
from vines.rig.quantities import SOURCES
from vines.stages.api._home import Home, current
from vines.stages.reports._document import Heading, Picture, Table, write_document
from vines.stages.rig._by_hand import compare_run, each_of, is_campaign
from vines.stages.rig._next import reconstructions_of
from vines.stages.rig._refused import reason_of
from vines.stages.rig._runs import free_decay
from vines.store import revision, versions

__all__ = ["report_campaign"]

_BUDGETED = ("r", "mu", "omega0", "A")
_PANELS = {
    "phase": "impact phase: signed $E_n$",
    "max_abs_x1": "max $|x_1|$: signed $E_n$",
    "kinetic_ratio": "$K_2/K_1$: signed $E_n$",
}
_BESIDE = ("mu_momentum", "sigma_r", "r_camera", "b_camera")


@dataclass(eq=False)
class _Campaign:
    """What a page tells: run folders, what came of them, and why nothing came of others."""

    name: str
    folders: list[Path]
    found: dict[str, Reconstruction] = field(default_factory=dict)
    comparisons: list[dict[str, Any]] = field(default_factory=list)
    lost: dict[str, str] = field(default_factory=dict)
    pictures: list[Picture] = field(default_factory=list)


def report_campaign(source: str | Path, out: Path, *, study: Home | None = None) -> Path:
    """Write a page about a campaign: set-up, calibration, ring-downs, verdicts, budgets, figures, origin.

    Parameters
    ----------
    source : str or Path
        A folder of runs or one run, which are reconstructed and compared, or the name of a pipeline that has done so.
    out : Path
        The page, ``.html``, ``.pdf`` (printed by Chromium) or ``.md`` (pictures in a folder beside it).
    study : Home, optional
        Whose; the one that the current folder belongs to if left out.

    Returns
    -------
    Path
        The page.

    Raises
    ------
    UnknownNameError, FileMissingError
        If there is no such folder or pipeline, no folder for the page, or no Chromium for PDF.
    ParameterError
        If the page ends in something else.
    RigError
        If there is no run folder with the ball.
    """
    study = study or current()
    campaign = _by_hand(Path(source), study) if Path(source).is_dir() else _of_pipeline(str(source), study)
    held = {path.name: _described(path) for path in campaign.folders}
    parts = [
        *_verdicts(campaign),
        *_setting(held),
        *_calibration(held),
        *_decays(campaign.folders, held),
        *_budgets(campaign),
        *_checks(campaign),
        *_pictures(campaign),
        *_origin(held),
    ]
    below = f"{len(held)} run folders; 0.6508(11) is 0.6508 with a standard uncertainty (GUM, k = 1) of 0.0011"
    write_document(out, f"Report on the rig: {campaign.name}", below, parts)
    return out


def _by_hand(folder: Path, study: Home) -> _Campaign:
    found = _Campaign(folder.resolve().name, list(find_runs(folder)))
    if is_campaign(folder):
        made = each_of(folder, lambda run: compare_run(run, study=study), study)
    else:
        made = iter([(folder.name, compare_run(folder, study=study), "")])
    for name, one, why in made:
        if one is None:
            found.lost[name] = why
            continue
        found.found[one.derived.found.run.run_id] = one.derived.found
        found.comparisons += one.rows
    return found


def _of_pipeline(name: str, study: Home) -> _Campaign:
    runs, lost = reconstructions_of(name, study=study)
    found = _Campaign(name, [], {run.run.run_id: run for run in runs}, lost=lost)
    pinned, _ = study.store.readable_pins()
    for stage, pin in pinned[name].items():
        if study.store.problem(pin["result"]):
            continue
        result = study.store.result(pin["result"])
        if "rig_runs" in result.tables:
            found.folders += list(find_runs(result.folder / "runs"))
            rows = result.table("rig_runs").to_pylist()
            found.lost |= {row["run_id"]: row["reason"] for row in rows if row["status"] == "failed"}
        if "comparisons" in result.tables:
            found.comparisons += result.table("comparisons").to_pylist()
        picture = result.folder / "picture.svg"
        if picture.is_file():
            own = result.manifest["ingredients"]["options"].get("title")
            found.pictures.append(Picture(own or f"{name}.{stage}", picture.read_bytes()))
    return found


def _described(path: Path) -> Any:
    """Return a run folder as its files describe it, or why they do not."""
    try:
        return read_folder(path)
    except VinesError as error:
        return reason_of(error)


def _verdicts(campaign: _Campaign) -> Iterator[Heading | Table]:
    best = {row["run_id"]: row for row in campaign.comparisons if row["rank"] == 0 and row["basis"] == "measured"}
    counts: dict[str, int] = {}
    for row in best.values():
        counts[row["verdict"]] = counts.get(row["verdict"], 0) + 1
    told = ", ".join(f"{count} {name.replace('_', ' ')}" for name, count in sorted(counts.items())) or "no run compared"
    failed = f"; {len(campaign.lost)} failed" if campaign.lost else ""
    yield Heading("Verdicts", [
        f"{told}{failed}. E_n = |measured − model| / (2 √(u² + u²)) of impact phase, max|x1| and K2/K1 is at most 1 "
        "where they agree. Verdicts are at the parameters as measured, before anything is calibrated.",
    ])  # fmt: skip
    rows = []
    for name, row in best.items():
        each = [row.get(f"E_n_{q}") for q in _PANELS]
        errors = "" if all(e is None for e in each) else " / ".join("–" if e is None else f"{e:.2f}" for e in each)
        numbers = [_number(campaign.found.get(name), q) for q in ("A", "Omega", "mu", "r")]
        reason = row["reason"] if row["verdict"] not in ("agree", "pattern_only") else ""
        accepted = "yes" if row["accepted"] else "no"
        verdict = row["verdict"].replace("_", " ")
        rows.append([name, accepted, *numbers, row["pattern"] or "", row.get("branch") or "", errors, verdict, reason])
    rows += [[name, "no", *[""] * 7, "failed", why] for name, why in campaign.lost.items() if name not in best]
    head = ["run", "accepted", "A", "Omega", "mu", "r", "shows", "branch", "E_n: phase / |x1| / K2:K1", "verdict"]
    head += ["reason"]
    yield Table(head, sorted(rows))


def _number(found: Reconstruction | None, name: str) -> str:
    if found is None or name not in found.quantities:
        return ""
    one = found.quantities[name]
    return _with_u(one.value, one.u)


def _with_u(value: float, u: float) -> str:
    """Return a value with the uncertainty of its last digits in brackets.

    Examples
    --------
    >>> _with_u(0.64970, 0.00083), _with_u(14.97, 0.05), _with_u(120.0, 30.0), _with_u(3.807, 0.0)
    ('0.64970(83)', '14.970(50)', '120(30)', '3.807')
    """
    if not u > 0 or not np.isfinite(u):
        return f"{value:.6g}"
    digits = min(max(0, 1 - int(np.floor(np.log10(u)))), 9)
    return f"{value:.{digits}f}({round(u * 10**digits):d})"


def _setting(held: dict[str, Any]) -> Iterator[Heading | Table]:
    yield Heading("Set-up", ["As the run folders state it; what differs from run to run has rows of its own."])
    rows: dict[tuple[str, ...], list[str]] = {}
    for name, one in held.items():
        if isinstance(one, str):
            continue
        run, form = one.info, one.form
        line = (
            _with_u(run.M.value, run.M.u), _with_u(1e3 * run.m.value, 1e3 * run.m.u),
            _with_u(1e3 * run.b.value, 1e3 * run.b.u), _stated(run.more.get("friction")), _stated(run.more.get("tilt")),
            "; ".join(f"{key}: {text}" for key, text in dict(form.materials or {}).items()) or "not stated",
        )  # fmt: skip
        rows.setdefault(line, []).append(name)
    head = ["runs", "M [kg]", "m [g]", "b [mm]", "friction [m/s²]", "tilt [m/s²]", "materials"]
    yield Table(head, [[_listed(names), *line] for line, names in rows.items()])
    done = []
    for name, one in held.items():
        if isinstance(one, str):
            continue
        run = one.info
        told = ["" if v is None else f"{v:.6g}" for v in (run.f_cmd, None if run.E_cmd is None else 1e3 * run.E_cmd)]
        warm = " to ".join(f"{t:.2f}" for t in run.temperature)
        done.append([name, run.start_utc, run.protocol, "in" if run.ball else "out", *told, f"{run.settle:g}", warm])
    head = ["run", "start (UTC)", "protocol", "ball", "f cmd [Hz]", "E cmd [mm]", "settle [s]", "temperature [°C]"]
    yield Table(head, done)


def _stated(given: object) -> str:
    if isinstance(given, dict) and {"value", "u"} <= given.keys():
        return _with_u(float(given["value"]), float(given["u"]))
    return "not measured"


def _listed(names: list[str]) -> str:
    return ", ".join(names) if len(names) < 5 else f"{names[0]} to {names[-1]} ({len(names)})"


def _calibration(held: dict[str, Any]) -> Iterator[Heading | Table]:
    yield Heading("Calibration", ["Sensors of the channels, with sensitivity and date of the calibration sheet."])
    rows: dict[tuple[str, ...], list[str]] = {}
    for name, one in held.items():
        if isinstance(one, str):
            continue
        for row in one.rows:
            scaled = row.sensitivity == "scaled"
            told = "in the file" if scaled else f"{row.sensitivity:.6g} {row.sensitivity_unit}"
            role = "" if row.role == row.name else f" ({row.role})"
            line = (
                row.name + role, row.sensor or "", row.serial or "", told, f"{100 * row.u_sensitivity:.2g} %",
                row.calibrated or "not stated", f"{row.range:g} {row.unit}",
                _with_u(round(1e6 * row.group_delay, 1), 1e6 * row.u_delay), f"{row.high_pass:.2g}", row.recorder or "",
            )  # fmt: skip
            rows.setdefault(line, []).append(name)
    head = ["channel", "sensor", "serial", "sensitivity", "u", "calibrated", "range", "delay [µs]", "high-pass [Hz]"]
    head += ["recorder", "runs"]
    yield Table(head, [[*line, _listed(names)] for line, names in rows.items()])


def _decays(folders: list[Path], held: dict[str, Any]) -> Iterator[Heading | Table]:
    yield Heading("Ring-downs", ["Free decays without the ball: natural frequency and damping at their temperature."])
    rows = []
    for path in folders:
        one = held[path.name]
        if isinstance(one, str) or one.info.protocol != "ringdown":
            continue
        made = free_decay(path)
        if isinstance(made, str):
            rows.append([path.name, "", "", "", "", f"failed: {made}"])
            continue
        warm = "" if not np.isfinite(made.temperature) else f"{made.temperature:.2f}"
        rows.append([
            path.name, _with_u(made.omega0.value, made.omega0.u), f"{made.omega0.value / (2 * np.pi):.6f}",
            _with_u(made.lam.value, made.lam.u), warm, f"{made.residual:.1e} of the first amplitude",
        ])  # fmt: skip
    head = ["run", "omega0 [rad/s]", "f0 [Hz]", "lam", "temperature [°C]", "left by the fit"]
    yield Table(head, rows)


def _budgets(campaign: _Campaign) -> Iterator[Heading | Table]:
    """Yield budgets: of each source its own uncertainty and what it adds, in the middle of the runs."""
    yield Heading("Uncertainty budget", [
        "By source: its own standard uncertainty, and what it adds to those of r, mu, omega0 and A, in their units "
        "(medians over the accepted runs; each run's own stand in the table rig_budgets). The last row is the root of "
        "the sum of squares.",
    ])  # fmt: skip
    fair = [one for one in campaign.found.values() if one.accepted] or list(campaign.found.values())
    rows = []
    for source, (unit, said) in SOURCES.items():
        parts = [_middle([one.budget.get(name, {}).get(source, 0.0) for one in fair]) for name in _BUDGETED]
        if not any(parts):
            continue
        own = [one.sources[source] for one in fair if source in one.sources]
        told = "" if not own else f"{_middle(own):.2g}" + (f" {unit}" if unit != "1" else "")
        rows.append([said.partition(";")[0], told, *("" if not part else f"{part:.1e}" for part in parts)])
    totals = [
        _middle([float(np.sqrt(sum(u * u for u in one.budget.get(name, {}).values()))) for one in fair])
        for name in _BUDGETED
    ]
    rows.append(["All together", "", *(f"{u:.1e}" for u in totals)])
    units = [QUANTITIES[name][0] for name in _BUDGETED]
    heads = [f"u({name})" + (f" [{unit}]" if unit != "1" else "") for name, unit in zip(_BUDGETED, units, strict=True)]
    yield Table(["source", "u of the source", *heads], rows if fair else [])


def _middle(values: list[float]) -> float:
    fair = [value for value in values if np.isfinite(value)]
    return float(np.median(fair)) if fair else 0.0


def _checks(campaign: _Campaign) -> Iterator[Heading | Table]:
    yield Heading("Gates and checks", ["What each reconstruction was asked; what failed, with what was found."])
    rows = []
    for name, one in sorted(campaign.found.items()):
        bad = [each for each in one.findings if not each.passed]
        passed = [each.name for each in one.findings if each.passed]
        others = "; ".join(f"{q} = {_number(one, q)}" for q in _BESIDE if q in one.quantities)
        state, share = "failed" if bad else "ok", f"{len(passed)} of {len(one.findings)}"
        rows.append([name, state, str(len(one.impacts)), share, "; ".join(each.text for each in bad), others])
    rows += [[name, "failed", "", "", why, ""] for name, why in sorted(campaign.lost.items())]
    yield Table(["run", "", "impacts", "passed", "what failed", "measured beside"], rows)


def _pictures(campaign: _Campaign) -> Iterator[Heading | Picture]:
    from vines.figures import AgreementRow, rig_agreement_figure

    best = [row for row in campaign.comparisons if row["rank"] == 0 and row["basis"] == "measured"]
    rows = []
    for row in sorted(best, key=lambda each: each["run_id"]):
        values = {
            name: tuple(row[key] for key in (name, f"u_{name}", f"model_{name}", f"u_model_{name}", f"E_n_{name}"))
            for name in _PANELS
            if row.get(f"E_n_{name}") is not None and row.get(f"u_model_{name}") is not None
        }
        if values:
            rows.append(AgreementRow(row["run_id"], values))  # pyright: ignore[reportArgumentType]
    if not rows and not campaign.pictures:
        return
    yield Heading("Comparison with the model")
    if rows:
        figure, stream = rig_agreement_figure(rows, _PANELS), io.BytesIO()
        figure.savefig(stream, format="svg", metadata={"Date": None})
        yield Picture(
            "Measured less modelled in units of 2 √(u² + u²): within ±1 they agree. Thin bars: measured, wide ones: "
            "model, one standard uncertainty either way.",
            stream.getvalue(),
        )
    yield from campaign.pictures


def _origin(held: dict[str, Any]) -> Iterator[Heading | Table]:
    told = ", ".join(f"{name} {number}" for name, number in versions().items())
    commit = revision()
    yield Heading("Origin", [f"Computed with {told}{f', revision {commit}' if commit else ''}. SHA-256 of raw files:"])
    rows = []
    for name, one in held.items():
        if isinstance(one, str):
            rows.append([name, "failed", one])
            continue
        try:
            rows += [[name, file, digest] for file, digest in raw_sums(one).items()]
        except (RigError, VinesError) as error:
            rows.append([name, "failed", reason_of(error)])
    yield Table(["run", "file", "SHA-256"], rows)
