"""Long runs in a session of Python: cut into slices without a bit of difference, and Ctrl-C is heard between them."""

import signal
import threading
from contextlib import contextmanager

import numpy as np
import pytest

import vines
from vines import Params
from vines.attractors import _settle
from vines.dynamics import _simulate, _slices, runs
from vines.systems import ImpactPair

SYSTEMS = {
    "periodic": (Params(mu=0.01, A=0.02), {}),
    "chaotic, with scatter of chatter": (Params(mu=0.05, A=0.08, Omega=0.9), {}),
    "impact pair": (ImpactPair(B=0.1, G=0.0, r=0.5), {}),
}


def values(found):
    return [getattr(found, name) for name in ("name", "regime", "final", "measures")]


@pytest.mark.parametrize("system", SYSTEMS)
def test_slices_change_no_bit(system, monkeypatch):
    p, start = SYSTEMS[system]
    whole = vines.simulate(p, periods=300, **start)
    settled = vines.settle(p, settle=300, **start)
    for length in (0.37, 41.0):
        monkeypatch.setattr(_slices, "SLICE", length)
        cut = vines.simulate(p, periods=300, **start)
        np.testing.assert_array_equal(cut.sample(500).view(np.uint8), whole.sample(500).view(np.uint8))
        assert cut.impacts.tobytes() == whole.impacts.tobytes()
        assert repr(values(vines.settle(p, settle=300, **start))) == repr(values(settled))


class HeardError(Exception):
    pass


@contextmanager
def heard_after(seconds):
    """Interrupt what is done inside, as Ctrl-C does."""

    def hear(number, frame):
        raise HeardError

    before = signal.signal(signal.SIGALRM, hear)
    signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        with pytest.raises(HeardError):
            yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)


@pytest.mark.parametrize(
    ("module", "kernel", "run"),
    [
        (_settle, "pass_over", lambda: vines.settle(Params(mu=0.01, A=0.02), settle=1e7)),
        (_simulate, "run_window", lambda: vines.simulate(Params(mu=0.01, A=0.02), periods=1e6)),
    ],
    ids=["settle", "simulate"],
)
def test_an_interruption_is_heard_between_slices(module, kernel, run, monkeypatch):
    vines.settle(Params(mu=0.01, A=0.02))  # its kernels are loaded
    real, calls = getattr(module, kernel), []

    def counted(*arguments):
        calls.append(1)
        return real(*arguments)

    monkeypatch.setattr(module, kernel, counted)
    with heard_after(0.2):
        run()
    assert 0 < len(calls) < 1000  # it takes so many, or ten times as many


def test_an_interruption_of_many_runs_does_not_wait_for_the_others():
    hold, done = threading.Event(), []

    def work(block):
        if block.start:
            hold.wait(30.0)
        done.append(block.start)

    with heard_after(0.2):
        runs.each_thread(work, (slice(k, k + 1) for k in range(50)), 2)
    assert done == [0]
    hold.set()
