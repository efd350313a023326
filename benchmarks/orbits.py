"""How fast orbits are: medians of processor time on one core, and AUTO-07p as the peer where it is installed.

Run as ``python -m benchmarks.orbits``. A 1:1 point of `symmetric_table` includes speed, phase and state of the
symmetric orbits, their four multipliers, stability, the certificate of admissibility with the least clearance, K2/K1
and max|x1|. AUTO continues the same branch as a boundary-value problem of two flights (10 equations, 12 boundary
conditions, the flight times free, 20 mesh intervals of 4 collocation points), without multipliers; start-up and
compilation are taken off. It needs Debian's auto-07p and gfortran. Processor time, because the machine may be shared.
"""

from __future__ import annotations

import os
import resource
import shutil
import statistics
import subprocess
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

from vines.dynamics import simulate
from vines.model import Params
from vines.orbits import Orbit, all_orbits, find_orbit, symmetric_orbits, symmetric_table

REPEATS = 7
POINTS = 20_000
AUTO_POINTS = 100
AUTO_HOME = Path("/usr/lib/auto-07p")
P = Params(mu=0.01, A=0.015)


def seconds(work: Callable[[], object], per: int = 1) -> float:
    """Return the median processor time of one of the `per` things that a call does."""
    work()
    times = []
    for _ in range(REPEATS):
        start = time.process_time()
        work()
        times.append((time.process_time() - start) / per)
    return statistics.median(times)


def table_points() -> float:
    rng = np.random.default_rng(1)
    mu, A = 10 ** rng.uniform(np.log10(0.005), 0, POINTS), rng.uniform(0.01, 1, POINTS)
    Omega, r = rng.uniform(0.6, 1.6, POINTS), rng.uniform(0.3, 0.9, POINTS)
    return seconds(lambda: symmetric_table(mu, A, Omega, r), POINTS)


def refined(orbit: Orbit) -> float:
    """Return the time for one orbit from the orbit at an amplitude 1 % away, with multipliers and measures."""
    p = orbit.params.replace(A=orbit.params.A * 1.01)
    return seconds(lambda: [find_orbit(orbit.word, p, guess=orbit) for _ in range(50)], 50)


EQUATIONS = """
SUBROUTINE FUNC(NDIM,U,ICP,PAR,IJAC,F,DFDU,DFDP)
IMPLICIT NONE
INTEGER, INTENT(IN) :: NDIM, ICP(*), IJAC
DOUBLE PRECISION, INTENT(IN) :: U(NDIM), PAR(*)
DOUBLE PRECISION, INTENT(OUT) :: F(NDIM)
DOUBLE PRECISION, INTENT(INOUT) :: DFDU(NDIM,NDIM), DFDP(NDIM,*)
INTEGER :: K
DOUBLE PRECISION :: A, W, LAM, TAU
A = PAR(1); W = PAR(6); LAM = PAR(7)
DO K = 0, 5, 5
  TAU = PAR(2 + K/5)
  F(K+1) = TAU*U(K+2)
  F(K+2) = TAU*(A*SIN(U(K+5)) + LAM*W*A*COS(U(K+5)) - LAM*U(K+2) - U(K+1))
  F(K+3) = TAU*U(K+4)
  F(K+4) = 0D0
  F(K+5) = TAU*W
END DO
END SUBROUTINE FUNC
SUBROUTINE BCND(NDIM,PAR,ICP,NBC,U0,U1,FB,IJAC,DBC)
IMPLICIT NONE
INTEGER, INTENT(IN) :: NDIM, ICP(*), NBC, IJAC
DOUBLE PRECISION, INTENT(IN) :: PAR(*), U0(NDIM), U1(NDIM)
DOUBLE PRECISION, INTENT(OUT) :: FB(NBC)
DOUBLE PRECISION, INTENT(INOUT) :: DBC(NBC,*)
DOUBLE PRECISION :: MU, R, K1, P1, K2, P2
MU = PAR(4); R = PAR(5)
K1 = (1-R*MU)/(1+MU); P1 = MU*(1+R)/(1+MU); P2 = (1+R)/(1+MU); K2 = (MU-R)/(1+MU)
FB(1) = U0(1) - U0(3) - 1
FB(2) = U1(1) - U1(3) + 1
FB(3) = U0(6) - U1(1)
FB(4) = U0(8) - U1(3)
FB(5) = U0(7) - K1*U1(2) - P1*U1(4)
FB(6) = U0(9) - P2*U1(2) - K2*U1(4)
FB(7) = U0(10) - U1(5)
FB(8) = U0(1) - U1(6)
FB(9) = U0(3) - U1(8)
FB(10) = U0(2) - K1*U1(7) - P1*U1(9)
FB(11) = U0(4) - P2*U1(7) - K2*U1(9)
FB(12) = U1(10) - U0(5) - 8*ATAN(1D0)
END SUBROUTINE BCND
SUBROUTINE STPNT(NDIM,U,PAR,T)
IMPLICIT NONE
INTEGER, INTENT(IN) :: NDIM
DOUBLE PRECISION, INTENT(INOUT) :: U(NDIM), PAR(*)
DOUBLE PRECISION, INTENT(IN) :: T
PAR(1:7) = (/ {A!r}D0, {half!r}D0, {half!r}D0, {mu!r}D0, {r!r}D0, {Omega!r}D0, {lam!r}D0 /)
END SUBROUTINE STPNT
SUBROUTINE ICND
END SUBROUTINE ICND
SUBROUTINE FOPT
END SUBROUTINE FOPT
SUBROUTINE PVLS
END SUBROUTINE PVLS
"""

SCRIPT = """
from auto import *
run(e='vines', dat='vines', NDIM=10, IPS=4, ILP=1, ICP=[1, 2, 3], NTST=20, NCOL=4, IAD=3, ISP=0, ISW=1, NBC=12, NINT=0,
    NMX={points}, NPR=0, RL0=0.0, RL1=0.06, EPSL=1e-8, EPSU=1e-8, EPSS=1e-6, DS=0.02, DSMIN=1e-7, DSMAX=0.1, IADS=1,
    ITNW=7, NWTN=3, ITMX=9, IID=2, NPAR=7)
"""


def auto_point() -> float | None:
    """Return AUTO's time for a point of the symmetric branch, None where it is not installed."""
    if shutil.which("autox") is None or shutil.which("gfortran") is None or not AUTO_HOME.is_dir():
        return None
    [orbit] = symmetric_orbits(P)
    half = orbit.period / 2
    share = np.linspace(0, 1, 41)
    flight = simulate(P, **orbit.start(), periods=1).sample(times=orbit.t[0] + share * half * (1 - 1e-12))
    v1 = np.append(orbit.impacts["v1_after"][0], flight["v1"][1:])
    ball = np.full_like(share, orbit.impacts["v2_after"][0])
    one = [flight["x1"], v1, flight["x2"], ball]
    phase = orbit.phase[0] + share * half * P.Omega
    columns = np.column_stack([share, *one, phase, *(-column for column in one), phase + np.pi])
    with tempfile.TemporaryDirectory() as folder:
        here = Path(folder)
        np.savetxt(here / "vines.dat", columns, fmt="%.16e")
        (here / "vines.f90").write_text(EQUATIONS.format(half=half, **P.as_dict()))
        auto_run(here, 2)
        times = []
        for _ in range(5):
            (short, first), (long, last) = auto_run(here, 2), auto_run(here, AUTO_POINTS)
            times.append((long - short) / (last - first))
    return statistics.median(times)


def auto_run(folder: Path, points: int) -> tuple[float, int]:
    """Let AUTO follow the branch; return the processor time and the number of points, fewer if it reaches A = .06."""
    (folder / "script.py").write_text(SCRIPT.format(points=points))
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run(
        ["autox", "script.py"],
        cwd=folder,
        env={**os.environ, "AUTO_DIR": str(AUTO_HOME), "OMP_NUM_THREADS": "1"},
        capture_output=True,
        text=True,
        check=True,
    )
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    reached = [int(row[1]) for row in map(str.split, done.stdout.splitlines()) if row[:1] == ["1"]]
    if not reached or reached[-1] < min(points, 20):
        raise RuntimeError(f"AUTO did not follow the branch:\n{done.stdout[-2000:]}")
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, reached[-1]


def rows() -> list[tuple[str, float]]:
    """Return (what, median seconds)."""
    low = P.replace(A=0.023)
    five = next(o for o in all_orbits("LLRLR/2T", low) if o.admissible)
    measured = [
        ("1:1 point, table over arrays", table_points()),
        ("1:1 orbits as objects", seconds(lambda: [symmetric_orbits(P) for _ in range(50)], 50)),
        ("2:1 from a neighbour, Newton", refined(find_orbit("LLR", low))),
        ("five impacts from a neighbour, Newton", refined(five)),
        ("all orbits of LR", seconds(lambda: all_orbits("LR", low))),
        ("all orbits of LLR", seconds(lambda: all_orbits("LLR", low))),
    ]
    peer = auto_point()
    return measured if peer is None else [*measured, ("peer: AUTO-07p, 1:1 point", peer)]


if __name__ == "__main__":
    measured = rows()
    table, peer = measured[0][1], dict(measured).get("peer: AUTO-07p, 1:1 point")
    print(f"{'what':40s} {'median us':>10s} {'per second':>11s} {'x table':>9s}")
    for name, value in measured:
        print(f"{name:40s} {value * 1e6:10.1f} {1 / value:11.0f} {value / table:9.1f}")
    if peer is None:
        print("peer: AUTO-07p is not installed (Debian: auto-07p, gfortran)")
