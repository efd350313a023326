"""Uncertainty budgets add up to what is stated, and every source is explained."""

import numpy as np
import pytest

from vines.rig.quantities import SOURCES
from vines.rig.records import budget_rows


def test_sources_add_up_to_the_standard_uncertainty(dwell):
    assert {"r", "mu", "omega0", "E", "A", "b", "impact_phase", "max_abs_x1", "kinetic_ratio"} <= dwell.budget.keys()
    for name, parts in dwell.budget.items():
        assert set(parts) <= set(SOURCES)
        # E's noise is correlated a little with what it is corrected by.
        total = np.sqrt(sum(u * u for u in parts.values()))
        assert total == pytest.approx(dwell.quantities[name].u, rel=5e-3), name


def test_a_budget_is_rows_with_the_source_s_own_number(dwell):
    rows = {(row["quantity"], row["source"]): row for row in budget_rows(dwell)}
    gauge = rows["A", "gauge"]
    assert (gauge["u_source"], gauge["unit_source"]) == (dwell.run.b.u, "m")
    weighed = rows["mu", "mass_ball"]
    assert weighed["u"] == pytest.approx(dwell.quantities["mu"].value * dwell.run.m.u / dwell.run.m.value)
    assert rows["r", "scatter"]["u_source"] is None
    assert len({row["point_id"] for row in rows.values()}) == len(rows)
