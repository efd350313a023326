"""The next contact against a search in 40 digits that cannot miss, over the whole range of parameters."""

from __future__ import annotations

import math
from collections.abc import Callable

import mpmath as mp
import pytest
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st

from vines.dynamics import simulate
from vines.model import Params

pytestmark = pytest.mark.long(14)

HORIZON = 4.0


class _Flight:
    """A flight in multiprecision."""

    def __init__(self, p: Params, x1: float, v1: float, x2: float, v2: float, phi: float) -> None:
        lam, Omega = mp.mpf(p.lam), mp.mpf(p.Omega)
        self.s = mp.mpc(-lam / 2, mp.sqrt(1 - lam**2 / 4))
        self.Omega = Omega
        self.g = mp.mpf(p.A) * (lam * Omega - 1j) * mp.expj(mp.mpf(phi)) / (1j * Omega - mp.conj(self.s))
        self.apart = 1j * Omega - self.s
        self.u = mp.mpc(x1, (self.g.real + self.s.real * mp.mpf(x1) - mp.mpf(v1)) / self.s.imag)
        self.x2, self.v2 = mp.mpf(x2), mp.mpf(v2)
        self.bend = float(abs(self.u) + abs(self.g) * (HORIZON * Omega**2 + 1 + Omega))
        """Bound of |w''| up to HORIZON: u'' = s^2 u + (s + i Omega) G, and u grows by |G| t at most."""
        if abs(self.apart) > 1e-6:
            steady = abs(self.g / self.apart)
            self.bend = min(self.bend, float(abs(self.u - self.g / self.apart) + steady * Omega**2))

    def w(self, t: float) -> mp.mpf:
        t = mp.mpf(t)
        free, forced = mp.exp(self.s * t), mp.expj(self.Omega * t)
        grown = t * free if self.apart == 0 else (forced - free) / self.apart
        return (self.u * free + self.g * grown).real - self.x2 - self.v2 * t

    def first_doubt(self, low: float, high: float, slack: float) -> float | None:
        """Start of the first interval in which |w| might exceed 1 + slack; None if it surely does not."""
        stack = [(low, high, abs(self.w(low)), abs(self.w(high)))]
        while stack:
            a, b, ya, yb = stack.pop()
            if max(ya, yb) + self.bend * (b - a) ** 2 / 8 < 1 + slack:
                continue
            if b - a < 1e-9 or ya > 1 + slack:
                return a
            m = 0.5 * (a + b)
            ym = abs(self.w(m))
            stack += [(m, b, ym, yb), (a, m, ya, ym)]
        return None


flights = given(
    mu=st.floats(-6, 1),
    A=st.sampled_from([0.0, 1e-3, 0.02, 0.3, 3.0, 10.0]),
    Omega=st.one_of(st.floats(0.05, 5.0), st.floats(0.98, 1.02), st.just(1.0)),
    lam=st.sampled_from([0.0, 1e-9, 1e-3, 0.012, 0.2, 1.5]),
    w=st.one_of(st.floats(-0.999, 0.999), st.sampled_from([-1.0, 1.0])),
    x1=st.floats(-2, 2),
    v1=st.floats(-2, 2),
    rate=st.floats(-3, 0.7),
    phi=st.floats(0, 6.28),
)


@settings(max_examples=400, deadline=None)
@flights
@example(mu=-6.0, A=10.0, Omega=1.0, lam=0.0, w=-1.0, x1=0.0, v1=0.0, rate=-3.0, phi=4.0)  # merged at the start
def test_never_missed_and_never_invented(**flight: float) -> None:
    _check(**flight)


@pytest.mark.full
def test_never_missed_and_never_invented_in_ten_thousand_flights(
    record_property: Callable[[str, object], None],
) -> None:
    count = {"flights": 0, "contacts": 0}

    @settings(max_examples=10_000, deadline=None, database=None, suppress_health_check=list(HealthCheck))
    @flights
    def many(**flight: float) -> None:
        count["contacts"] += _check(**flight)
        count["flights"] += 1

    many()
    for name, value in count.items():
        record_property(name, value)
    print(f"{count['flights']} flights against a search in 40 digits, {count['contacts']} of them with a contact")
    assert count["flights"] >= 10_000


def _check(
    mu: float, A: float, Omega: float, lam: float, w: float, x1: float, v1: float, rate: float, phi: float
) -> bool:
    """Check one flight; return whether there was a contact."""
    p = Params(mu=10**mu, A=A, Omega=Omega, r=0.65, lam=lam)
    side = math.copysign(1.0, w)
    x2, v2 = x1 - w, v1 + side * 10**rate
    if abs(w) == 1.0:
        x2 = x1 - side
    with mp.workdps(40):
        flight = _Flight(p, x1, v1, x2, v2, phi)
        size = 1e-13 * (1.0 + float(abs(flight.u) + HORIZON * abs(flight.g)))
        horizon = min(HORIZON, 1.5 * p.period)
        run = simulate(p, x1=x1, v1=v1, x2=x2, v2=v2, phi=phi, periods=horizon / p.period)
        # A start on the wall leaves it at 10**rate; until then |w| is below 1 by the bound of w''.
        low = 1.8 * 10**rate / flight.bend if abs(w) == 1.0 and flight.bend > 0 else 0.0
        if len(run.sticks) and not run.sticks["impacts"][0]:
            # A chatter whose rest changes nothing is left out as a whole: its first contact comes before its end.
            end = float(run.sticks["t_start"][0])
            assert not len(run.impacts) or run.impacts["t"][0] > end
            assert flight.first_doubt(min(low, end), end, -size) is not None
            return True
        if not len(run.impacts):
            doubt = flight.first_doubt(min(low, horizon), horizon, 0.0)
            assert doubt is None or abs(abs(flight.w(doubt)) - 1) < 100 * size
            return False
        hit = run.impacts[0]
        t = float(hit["t"])
        assert abs(flight.w(t) - int(hit["side"])) < size * max(1.0, t)
        assert hit["side"] * hit["w_dot"] >= 0.0
        if t > low:
            assert flight.first_doubt(low, t, 100 * size) is None
        return True


@given(gap=st.floats(1e-12, 1e-3), miss=st.booleans())
@settings(max_examples=60, deadline=None)
def test_grazing_is_decided_by_the_height_of_the_peak(gap: float, miss: bool) -> None:
    # Without forcing or damping x1 = R cos t with the ball at rest at x2 = R - 1 +- gap.
    R = 0.5
    p = Params(mu=0.01, A=0.0, Omega=2.0, lam=0.0)
    x2 = R - 1.0 + (gap if miss else -gap)
    run = simulate(p, x1=R * math.cos(-1.0), v1=-R * math.sin(-1.0), x2=x2, v2=0.0, periods=0.5)
    assert (len(run.impacts) == 0) == miss
    if not miss:
        assert math.isclose(run.impacts["t"][0], 1.0 - math.acos(1.0 - gap / R), abs_tol=1e-7)
