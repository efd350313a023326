"""Which attractors of sweeps are one."""

import pyarrow as pa

from vines.stages.bodies._distinct import all_attractors

PERIODIC = {"regime": "periodic", "n": 2, "m": 1, "p": 1, "kinetic_ratio": 1.0, "max_abs_x1": 0.5}
CHAOTIC = {
    **{"regime": "chaotic", "name": None, "n": None, "m": None, "p": None, "kinetic_ratio": 1.0, "max_abs_x1": 0.5},
    **{"kinetic_ratio_error": 0.01, "rms_x1": 0.3, "rms_x1_error": 0.01},
}
REST = {"kinetic_ratio_error": 0.0, "rms_x1": 0.3, "rms_x1_error": 0.0}


def test_every_attractor_is_seen_once_and_failed_points_never():
    up = [{"A": 0.1, **PERIODIC, **REST}, {"A": 0.2, **CHAOTIC}, {"A": 0.3, **PERIODIC, **REST, "kinetic_ratio": None}]
    down = [{"A": 0.1, **CHAOTIC}, {"A": 0.2, **CHAOTIC}]
    own = {"A": 0.1, "attractor": 0, **PERIODIC, **REST}
    other = {**own, "attractor": 1, "kinetic_ratio": 4.0}
    attractors = [own, other, {**other, "attractor": 2, **CHAOTIC}]
    seen = all_attractors("A", [pa.Table.from_pylist(rows) for rows in (up, down)], [pa.Table.from_pylist(attractors)])
    assert [(one.x, one.kinetic_ratio, one.found) for one in seen] == [
        (0.1, 1.0, 0),
        (0.1, 1.0, 1),
        (0.1, 4.0, 2),
        (0.2, 1.0, 0),
    ]
