"""Units as recorders and people write them; factors by hand, from the SI Brochure and NIST SP 811."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from vines.errors import RigError
from vines.rig.units import si_factor, volts_per_unit

SPELLINGS = {
    ("voltage", 1.0): "V v Volt Volts volts VOLTS VDC [V] <V> (V)|V DC|Volts DC",
    ("voltage", 1e-3): "mV mv mVolts millivolts Millivolt",
    ("voltage", 1e6): "MV",
    ("acceleration", 1.0): "m/s^2 m/s2 m/s² m/s/s m/s**2 M/S^2 m·s⁻² Meters/Second^2 m/sec^2 (m/s²) m/(s^2)|m s^-2"
    "|meters per second squared|m / s^2",
    ("acceleration", 9.80665): "g G g's gn g_n gs",
    ("acceleration", 9.80665e-3): "mg mG MG",
    ("acceleration", 0.0254): "Inches/Second^2 in/s^2 in/s²",
    ("velocity", 1e-3): "mm/s mm/sec MM/S",
    ("velocity", 0.0254): "in/s ips Inches/Second",
    ("displacement", 1e-3): "mm MM ㎜ millimeters Millimetre",
    ("displacement", 1e-6): "µm μm um UM micron microns Mikrometer micrometers",
    ("displacement", 0.0254): 'in inch Inches "',
    ("displacement", 2.54e-5): "mil mils thou",
    ("time", 1.0): "s S sec Sec Seconds second Sekunden",
    ("time", 1e-3): "ms mS MS msec MSEC milliseconds",
    ("time", 1e-6): "us µs μs usec Microseconds",
    ("temperature", 1.0): "degC °C ℃|Deg C|deg C|° C",
    ("frequency", 1e3): "kHz KHZ kS/s",
    ("force", 4.4482216152605): "lbf",
    ("count", 1.0): "counts LSB digits",
}
NO_UNITS = [
    "",
    " ",
    "-",
    "n/a",
    "1",
    "%",
    "dB",
    "V rms",
    "Vrms",
    "kg",
    "x",
    "m/",
    "/s",
    "m//s",
    "(m",
    "g g",
    "lo",
    "None",
]


@pytest.mark.parametrize(
    ("meaning", "text"),
    [
        (meaning, text)
        for meaning, texts in SPELLINGS.items()
        for first, *others in [texts.split("|")]
        for text in (*first.split(), *others)
    ],
)
def test_spellings(meaning, text):
    quantity, factor = si_factor(text)
    assert (quantity, factor) == (meaning[0], pytest.approx(meaning[1], rel=1e-12))
    assert si_factor(f"  [{text}] ") == (quantity, factor)


@pytest.mark.parametrize("text", NO_UNITS)
def test_what_is_no_unit(text):
    with pytest.raises(RigError, match="is not known"):
        si_factor(text)


@given(st.text("mVgs/^2 ()[]µ-·*°", max_size=10))
def test_any_text_is_a_unit_or_refused_in_one_line(text):
    said = ""
    try:
        quantity, factor = si_factor(text)
    except RigError as error:
        said = str(error)
    assert "\n" not in said
    assert said or (quantity and factor > 0)


@pytest.mark.parametrize(
    ("number", "unit", "quantity", "volts"),
    [
        (100.0, "mV/g", "acceleration", 0.1 / 9.80665),
        (100.0, "mVolts per g", "acceleration", 0.1 / 9.80665),
        (10.0, "mV/(m/s²)", "acceleration", 0.01),
        (10.0, "mV/m/s^2", "acceleration", 0.01),
        (2.0, "Volts/mm", "displacement", 2000.0),
        (0.5, "Millimeters/Volt", "displacement", 2000.0),
        (50.0, "(mm/s)/V", "velocity", 20.0),
    ],
)
def test_sensitivities(number, unit, quantity, volts):
    assert volts_per_unit(number, unit) == (quantity, pytest.approx(volts, rel=1e-12))
