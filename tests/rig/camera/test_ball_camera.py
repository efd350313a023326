"""A camera on the ball: its impacts, its clock, and what it says beside what was inferred, against the sealed truth."""

from dataclasses import replace

import msgspec
import numpy as np
import pytest

from tests.rig.conftest import DWELL
from vines.errors import ParameterError, RigError
from vines.rig import Uncertain, read_run, reconstruct
from vines.rig.camera import align, find_flights, see_ball
from vines.rig.fit import root
from vines.rig.formats import RawChannel
from vines.rig.ingest._frames import frames_lost, whole_frames
from vines.rig.quantities._camera import with_camera
from vines.rig.synth import BallCamera, RigSettings, make_run, raw_run, read_raw

CAMERA = BallCamera(late=0.3, ppm=40.0)
GAUGE = Uncertain(0.015, 5e-5)


@pytest.fixture(scope="module")
def filmed():
    return raw_run(msgspec.structs.replace(DWELL, camera=CAMERA), 7)


@pytest.fixture(scope="module")
def recording(filmed):
    return read_raw(filmed)


def changed(recording, sign=1.0, scale=1.0):
    camera = recording.channels["ball_cam"]
    other = replace(camera, values=sign * scale * camera.values)
    return replace(recording, channels={**recording.channels, "ball_cam": other})


def beside(dwell, recording):
    sight = see_ball(recording, root(dwell.quantities["omega0"].value, 0.012), dwell.track.motion.omega)
    assert sight is not None
    return with_camera(dwell, sight, GAUGE)


def aligned(flights, channel):
    found = align(flights, channel, root(55.39, 0.012), 2 * np.pi * DWELL.f)
    assert found is not None
    return found


def failed(found):
    return {finding.name: finding.text for finding in found.findings if not finding.passed}


def test_a_camera_leaves_every_other_sample_and_the_truth_as_they_are(filmed, raw):
    (name,) = raw.files
    for one, other in zip(raw.files[name].channels, filmed.files[name].channels, strict=True):
        assert np.array_equal(one.values, other.values)
    assert "camera" not in raw.truth["settings"]
    assert filmed.truth["impacts"] == raw.truth["impacts"]


@pytest.mark.parametrize(("rate", "noise", "most"), [(200.0, 5e-5, 1.2e-4), (500.0, 5e-5, 6e-5), (500.0, 1e-5, 3e-5)])
def test_impacts_of_a_bouncing_ball_come_within_their_uncertainty(rate, noise, most):
    rng = np.random.default_rng(3)
    times = np.cumsum(rng.uniform(0.05, 0.065, 150))
    speeds = np.where(np.arange(150) % 2, -1, 1) * rng.uniform(0.35, 0.6, 150)
    t = np.arange(times[0] + 0.02, times[-1], 1 / rate)
    x = np.concatenate([[0.0], np.cumsum(np.diff(times) * speeds[:-1])])
    shown = np.interp(t, times, x) + rng.normal(0.0, noise, len(t))
    found = find_flights(t, shown, rng.random(len(t)) > 0.01, rate)
    true = times[1:-1]
    place = np.argmin(np.abs(found.t[:, None] - true), axis=1)
    away = found.t - true[place]
    assert len(found) >= len(true) - 1
    assert np.sqrt(np.mean(away**2)) < most
    assert 0.4 < np.std(away / found.u_t) < 1.5
    turn = found.v_after - found.v_before
    assert (
        np.std((turn - np.diff(speeds)[place])[found.clear] / np.hypot(found.u_before, found.u_after)[found.clear]) < 2
    )
    assert np.array_equal(found.side, np.sign(np.diff(speeds[:-1]))[place])


def test_a_ball_that_rests_or_flies_once_has_no_impacts():
    t = np.arange(300) / 500
    noise = np.random.default_rng(1).normal(0.0, 5e-5, 300)
    assert len(find_flights(t, noise, np.ones(300, bool), 500.0)) == 0
    assert len(find_flights(t, 0.4 * t - 0.05 * t**2 + noise, np.ones(300, bool), 500.0)) == 0
    assert len(find_flights(t, noise, np.zeros(300, bool), 500.0)) == 0


def test_clock_and_sign_are_found_from_momentum(recording, filmed):
    camera = recording.channels["ball_cam"]
    flights = find_flights(camera.times, camera.values, camera.valid, camera.rate)
    for role in ("lo_disp", "lo_acc"):
        found = aligned(flights, recording.role(role))
        assert found.fits
        assert found.told
        assert found.sign == 1
        assert found.lag == pytest.approx(CAMERA.late, abs=3e-4)
        assert found.pace == pytest.approx(1 + 1e-6 * CAMERA.ppm, abs=3e-5)
    turned = replace(flights, v_before=-flights.v_before, v_after=-flights.v_after)
    assert aligned(turned, recording.role("lo_acc")).sign == -1
    wild = replace(flights, t=np.sort(np.random.default_rng(2).uniform(0, 12, len(flights))))
    assert not aligned(wild, recording.role("lo_acc")).fits


def test_a_good_camera_agrees_with_what_was_inferred(dwell, recording, filmed):
    found = beside(dwell, recording)
    assert not failed(found)
    q = found.quantities
    true = np.array(filmed.truth["impacts"]["r"]).mean()
    assert abs(q["r_camera"].value - true) < 2 * q["r_camera"].u
    assert q["r_camera"].u < 0.003
    assert q["b_camera"].value == pytest.approx(0.015, abs=2 * q["b_camera"].u)
    assert q["camera_lag"].value == pytest.approx(CAMERA.late, abs=3e-4)
    (said,) = [one.text for one in found.findings if one.name == "camera_impacts"]
    shared = int(said.split()[0])
    assert 0.97 * len(dwell.impacts) * (12 - CAMERA.late) / 12 < shared <= len(dwell.impacts)
    assert said.split(": ")[0].endswith("0 by ball_cam alone (0 taken over), 0 by the oscillator alone")


@pytest.mark.parametrize(
    ("sign", "scale", "name", "said"),
    [(-1.0, 1.0, "camera_sign", "walls are swapped"), (1.0, 1.1, "camera_scale", "off by a factor of 1.1"),
     (1.0, 25.4, "camera_scale", "off by a factor of 25."), (-1.0, 0.8, "camera_sign", "sign of ball_cam")],
)  # fmt: skip
def test_a_wrong_sign_or_scale_is_named(dwell, recording, sign, scale, name, said):
    found = beside(dwell, changed(recording, sign, scale))
    assert not found.accepted
    assert said in failed(found)[name]


def test_a_camera_on_something_else_is_said(dwell, recording):
    camera = recording.channels["ball_cam"]
    jumping = replace(camera, values=0.01 * np.sign(np.sin(2 * np.pi * 3.3 * camera.times)) * (camera.times % 0.15))
    found = beside(dwell, replace(recording, channels={**recording.channels, "ball_cam": jumping}))
    assert list(failed(found)) == ["camera"]


def test_impacts_that_the_oscillator_s_sensors_lose_are_taken_from_the_camera(ringdown):
    settings = RigSettings(
        duration=12.0, settle=30.0, sigma_r=0.01, friction=0.005, E=0.015 * 0.0228, laser_noise=2e-5, rate=12800.0,
        channels=("base_disp", "lo_disp"), camera=BallCamera(),
    )  # fmt: skip
    run = raw_run(settings, 7)
    recording = read_raw(run)
    blind = replace(recording, channels={k: one for k, one in recording.channels.items() if k != "ball_cam"})
    with pytest.raises(RigError, match="4 impacts, allowed are 6 and more: did the ball move"):
        reconstruct(blind, [ringdown])
    found = reconstruct(recording, [ringdown])
    true = np.array(run.truth["impacts"]["t"])
    assert found.accepted, found.reasons
    assert found.pattern.name == "2:1"
    assert np.mean(found.impacts["by_camera"]) > 0.9
    assert len(found.impacts) == len(true)
    away = np.min(np.abs(found.impacts["t"][:, None] - true), axis=1)
    assert np.sqrt(np.mean(away**2)) < 1.5e-4
    q = found.quantities
    assert abs(q["r"].value - run.truth["parameters"]["r"]) < 2 * q["r"].u
    assert f"({np.count_nonzero(found.impacts['by_camera'])} taken over)" in next(
        one.text for one in found.findings if one.name == "camera_impacts"
    )


def test_a_run_folder_with_a_camera_is_read_and_its_gaps_are_flagged(tmp_path):
    settings = RigSettings(run_id="a", duration=3.0, settle=1.0, rate=12800.0, camera=BallCamera(lost=0.05))
    make_run(tmp_path / "a", settings, 1)
    found = read_run(tmp_path / "a")
    camera = found.recording.channels["ball_cam"]
    assert (camera.rate, camera.role) == (500.0, "ball_cam")
    assert 0.85 < camera.valid.mean() < 0.99
    assert np.isfinite(camera.values).all()
    assert "impacts bring it onto the clock of the run" in found.clocks["camera"].how
    text = (tmp_path / "a/raw/camera.csv").read_text().splitlines()
    kept = [line for line in text if not line.endswith(",")]
    assert len(kept) < len(text)
    (tmp_path / "a/raw/camera.csv").write_text("\n".join(kept) + "\n")
    again = read_run(tmp_path / "a").recording.channels["ball_cam"]
    assert np.allclose(again.values[: len(camera.values)], camera.values[: len(again.values)])
    assert again.valid.mean() == pytest.approx(camera.valid.mean(), abs=0.01)


def test_a_ball_that_is_never_in_sight_is_refused():
    with pytest.raises(RigError, match=r"ball_cam: the ball is lost in 100% of the frames, allowed are 50%"):
        frames_lost(np.full(9, np.nan), "ball_cam", 1.0)


def test_stamps_that_are_no_frames_are_left_to_the_check_of_the_rate():
    times = np.array([0.0, 0.1, 0.2, 0.34, 0.51])
    raw = RawChannel("x", np.arange(5.0), times=times)
    assert whole_frames(raw) is raw


@pytest.mark.parametrize("wrong", [{"rate": 0.0}, {"late": 9.0}, {"lost": 0.9}])
def test_a_camera_that_cannot_be_is_refused(wrong):
    with pytest.raises(ParameterError, match=rf"camera\.{next(iter(wrong))} is .*, allowed is"):
        RigSettings(camera=BallCamera(**wrong)).check()
