"""Velocities, force, temperature and sound beside displacement and acceleration: read, checked, used."""

import msgspec
import numpy as np
import pytest

from vines.errors import RigError
from vines.rig import ring_down
from vines.rig.formats import RawChannel, RawFile
from vines.rig.ingest import assemble
from vines.rig.quantities._forcing import measure_base
from vines.rig.records import channel_rows
from vines.rig.synth import RigSettings, raw_run, read_raw

FREE = RigSettings(
    run_id="free", protocol="ringdown", ball=False, E=0.0, duration=10.0, settle=0.0, rate=12800.0,
    start=(0.004, 0.0, 0.0, 0.0),
)  # fmt: skip
FORCED = RigSettings(duration=4.0, settle=1.0, rate=12800.0)
UNITS = {"velocity": "m/s", "force": "N", "temperature": "degC", "pressure": "Pa"}


def added(run, drop=(), **signals):
    """Return a run with channels that hold SI units: role to quantity, values, and what its row says otherwise."""
    held = read_raw(run)
    (name,) = run.files
    channels = [
        RawChannel(each.name, np.asarray(each.values, float) * float(each.about["slope"]), "V", each.rate, each.start)
        for each in run.files[name].channels
    ]
    rows = [row for row in run.rows if row.role not in drop]
    for role, (quantity, values, stated) in signals.items():
        said = dict(stated)
        rate = said.pop("rate", run.rows[0].fs)
        row = msgspec.structs.replace(
            run.rows[0], name=role, role=role, quantity=quantity, field=role, unit=UNITS[quantity],
            sensitivity="scaled", sensitivity_unit="", fs=rate, range=1e3, group_delay=0.0, t0=0.0, high_pass=0.0,
        )  # fmt: skip
        channels.append(RawChannel(role, values, said.pop("told", UNITS[quantity]), rate, 0.0))
        rows.append(msgspec.structs.replace(row, **said))
    return held, assemble(run.form, tuple(rows), {name: RawFile("tdms", tuple(channels), None)}, {})


def velocity(recording, role):
    """Return the velocity on the grid of the recorder, by differences of the displacement as it was recorded."""
    channel = recording.role(role)
    speed = np.gradient(channel.values, 1 / channel.rate)
    grid = np.arange(len(speed)) / channel.rate
    return np.interp(grid, channel.times, speed)


@pytest.fixture(scope="module")
def forced():
    return raw_run(FORCED, 3)


@pytest.fixture(scope="module")
def free():
    return raw_run(FREE, 3)


def test_velocities_are_laid_beside_displacement_and_acceleration(forced):
    held = read_raw(forced)
    speeds = {f"{body}_vel": ("velocity", velocity(held, f"{body}_disp"), {}) for body in ("base", "lo")}
    _, found = added(forced, **speeds)
    said = {text.partition(":")[0]: text for text in found.compared}
    for body in ("base", "lo"):
        for pair in (f"{body}_vel against {body}_disp", f"{body}_acc against {body}_vel"):
            ratio, angle = said[pair].partition(": ")[2].split(", ")
            assert float(ratio.split()[0]) == pytest.approx(1.0, abs=0.05)
            assert abs(float(angle.split()[0])) < 3.0
    assert "base_vel against the command" in said
    rows = {row["channel"]: row for row in channel_rows(found)}
    assert (rows["lo_vel"]["quantity"], rows["lo_vel"]["si_unit"]) == ("velocity", "m/s")


@pytest.mark.parametrize(
    ("said", "reason"),
    [
        ({"sign": "-1"}, "with opposite signs"),
        ({"unit": "mm/s", "told": None}, "a unit or a sensitivity is wrong"),
        ({"unit": "m/s^2", "told": None}, "is a acceleration, but lo_vel is a velocity"),
    ],
)
def test_a_velocity_that_contradicts_is_refused(forced, said, reason):
    with pytest.raises(RigError, match=reason):
        added(forced, lo_vel=("velocity", velocity(read_raw(forced), "lo_disp"), dict(said)))


def test_a_vibrometer_on_the_base_gives_the_forcing(forced):
    held, found = added(
        forced, ("base_disp", "base_acc"), base_vel=("velocity", velocity(read_raw(forced), "base_disp"), {})
    )
    one, other = measure_base(held), measure_base(found.recording)
    assert other.channel.role == "base_vel"
    assert other.E.value == pytest.approx(one.E.value, rel=1e-3)
    assert other.f.value == pytest.approx(one.f.value, rel=1e-5)
    assert abs(np.angle(np.exp(1j * (other.phase.value - one.phase.value)))) < 5e-3


def test_a_vibrometer_on_the_oscillator_gives_the_ring_down(free):
    held, found = added(free, ("lo_disp", "lo_acc"), lo_vel=("velocity", velocity(read_raw(free), "lo_disp"), {}))
    one, other = ring_down(held), ring_down(found.recording)
    assert other.omega0.value == pytest.approx(one.omega0.value, rel=2e-5)
    assert other.lam.value == pytest.approx(one.lam.value, rel=0.02)


def test_force_temperature_and_sound_are_kept_and_the_temperature_checked(forced):
    rng = np.random.default_rng(1)
    before, after = forced.form.temperature_before, forced.form.temperature_after
    signals = {
        "stinger_force": ("force", rng.normal(size=51200), {}),
        "sound": ("pressure", 0.1 * rng.normal(size=51200), {}),
        "temperature": ("temperature", np.round(np.linspace(before, after, 4), 1), {"rate": 1.0}),
    }
    _, found = added(forced, **signals)
    rows = {row["channel"]: row for row in channel_rows(found)}
    assert [rows[name]["si_unit"] for name in signals] == ["N", "Pa", "degC"]
    assert rows["temperature"]["clipped"] == 0
    assert any(text.startswith("temperature against temperature_after: ") for text in found.compared)
    signals["temperature"] = ("temperature", np.full(4, before + 5.0), {"rate": 1.0})
    with pytest.raises(RigError, match=r"it says .* degC, temperature_before is"):
        added(forced, **signals)
