"""Units that laboratories and recorders write, in SI. What cannot be read is refused, never guessed.

Symbols, prefixes and factors are those of the SI Brochure (BIPM, 9th ed.) and of NIST SP 811, appendix B; names are
those that NI DAQmx, LabVIEW, oscilloscopes and modal analysers write. A general library of units (pint) reads ``g`` as
gram, ``G`` as gauss and, where case is to be ignored, ``mm`` as millimolar: what a unit means depends on who writes it.
"""

from __future__ import annotations

import functools
import re
import unicodedata

from vines.errors import RigError, nearest

__all__ = ["UNITS", "si_factor", "volts_per_unit"]

_PREFIXES = {"n": 1e-9, "u": 1e-6, "m": 1e-3, "c": 1e-2, "d": 1e-1, "": 1.0, "k": 1e3, "M": 1e6}
_PREFIX_WORDS = {"nano": "n", "micro": "u", "mikro": "u", "milli": "m", "centi": "c", "zenti": "c", "kilo": "k"}

UNITS: dict[str, tuple[str, float, str, str]] = {
    "V": ("V", 1.0, "numkM", "volt volts vdc volt-dc volts-dc v-dc"),
    "m": ("m", 1.0, "numcdk", "meter meters metre metres"),
    "in": ("m", 0.0254, "", 'inch inches zoll "'),
    "ft": ("m", 0.3048, "", "foot feet"),
    "mil": ("m", 2.54e-5, "", "mils mil. thou"),
    "micron": ("m", 1e-6, "", "microns"),
    "s": ("s", 1.0, "num", "second seconds sec secs sekunde sekunden"),
    "min": ("s", 60.0, "", "minute minutes minuten"),
    "h": ("s", 3600.0, "", "hour hours hr hrs stunde stunden"),
    "Hz": ("s^-1", 1.0, "mkM", "hertz s/s sa/s samples/s samples/second samples/sec sps"),
    "kS/s": ("s^-1", 1e3, "", "ksa/s ksps"),
    "g": ("m s^-2", 9.80665, "um", "gn g_n g0 gs g's g-force"),
    "Gal": ("m s^-2", 0.01, "", ""),
    "ips": ("m s^-1", 0.0254, "", ""),
    "N": ("N", 1.0, "mk", "newton newtons"),
    "lbf": ("N", 4.4482216152605, "", ""),
    "Pa": ("Pa", 1.0, "umkM", "pascal pascals"),
    "bar": ("Pa", 1e5, "m", ""),
    "psi": ("Pa", 6894.757293168, "", ""),
    "A": ("A", 1.0, "um", "amp amps ampere amperes"),
    "degC": ("degC", 1.0, "", "°c celsius deg-c deg.c grad-c"),
    "count": ("count", 1.0, "", "counts cts lsb lsbs digit digits steps raw adc"),
}
"""By symbol: powers of base units, factor to them, prefixes that are in use, other names."""

_QUANTITIES = {
    "V": "voltage", "m": "displacement", "m s^-1": "velocity", "m s^-2": "acceleration", "N": "force", "s": "time",
    "s^-1": "frequency", "Pa": "pressure", "A": "current", "degC": "temperature", "count": "count",
}  # fmt: skip
_OTHER_SIGNS = str.maketrans({"μ": "u", "µ": "u", "·": " ", "⋅": " ", "*": " ", "−": "-", "’": "'", "`": "'"})
_TOKEN = re.compile(r"\s*(?:(?P<name>[a-z°\"'_]+)(?:\^?(?P<power>-?[1-9]))?|(?P<sign>[/()]))", re.IGNORECASE)


@functools.cache
def _names() -> tuple[dict[str, tuple[str, float]], dict[str, tuple[str, float]]]:
    """Return symbols with prefixes as they are written, and words and symbols whose case does not matter."""
    symbols: dict[str, tuple[str, float]] = {}
    words: dict[str, tuple[str, float]] = {}
    for symbol, (powers, factor, prefixes, others) in UNITS.items():
        for mark in ("", *prefixes):
            size = factor * _PREFIXES[mark]
            symbols[mark + symbol] = (powers, size)
            # An upper-case M is mega and nothing else. A single N or A is too short to be told from a word.
            if mark != "M" and mark + symbol not in ("N", "A"):
                words.setdefault((mark + symbol).casefold(), (powers, size))
        for name in others.split():
            words[name] = (powers, factor)
            if name.isalpha() and prefixes:
                # mVolts and msec as well as millivolts.
                words |= {mark + name: (powers, factor * _PREFIXES[mark]) for mark in prefixes if mark in "num"}
                words |= {long + name: (powers, factor * _PREFIXES[mark]) for long, mark in _PREFIX_WORDS.items()}
    return symbols, words


def _named(text: str) -> tuple[dict[str, int], float] | None:
    """Return powers and factor of one name; ``None`` if it is none."""
    symbols, words = _names()
    found = symbols.get(text) or words.get(text.casefold())
    if found is None:
        return None
    powers, factor = found
    return {part.partition("^")[0]: int(part.partition("^")[2] or 1) for part in powers.split()}, factor


def _normal(text: str) -> str:
    """Return a unit in one spelling of signs: no superscripts, no outer brackets, one blank."""
    # NFKC turns superscripts into digits, and signs such as the one for degrees Celsius into letters.
    text = unicodedata.normalize("NFKC", text.replace("⁻", "-")).replace("**", "^").translate(_OTHER_SIGNS)
    text = " ".join(text.split())
    pairs = {"[": "]", "(": ")", "<": ">", "{": "}"}
    while len(text) > 1 and pairs.get(text[0]) == text[-1] and not re.match(r"[^()]*\)", text[1:-1]):
        text = text[1:-1].strip()
    text = re.sub(r"\s+per\s+", "/", text, flags=re.IGNORECASE)
    text = re.sub(r"\s*(?:squared|\^\s*2)", "^2", text, flags=re.IGNORECASE)
    return re.sub(r"(?i)(?<![a-z])(v|volts?|deg|grad|°)[ .-]?(dc|c)\b", lambda two: f"{two[1]}-{two[2]}", text)


def _read(text: str) -> tuple[dict[str, int], float] | None:
    """Return powers of base units and factor; ``None`` if the text is no unit."""
    whole = _named(text) or _named(text.replace("-", ""))
    if whole is not None:
        return whole
    powers: dict[str, int] = {}
    factor, sign, place, last = 1.0, 1, 0, "("
    depth: list[int] = []
    while place < len(text):
        found = _TOKEN.match(text, place)
        if found is None:
            return None
        place = found.end()
        mark = found["sign"]
        if mark == "(":
            depth.append(sign)
        elif mark == ")":
            if not depth:
                return None
            sign = depth.pop()
        elif mark == "/":
            if last in ("/", "("):
                return None
            # m/s/s is m/(s s): a slash in a bracket turns what follows within that bracket.
            sign = -(depth[-1] if depth else 1)
        else:
            one = _named(found["name"])
            if one is None:
                return None
            power = sign * int(found["power"] or 1)
            factor *= one[1] ** power
            for base, inner in one[0].items():
                powers[base] = powers.get(base, 0) + inner * power
        last = mark or ""
    return None if depth or last in ("/", "(") else (powers, factor)


def si_factor(unit: str) -> tuple[str, float]:
    """Return the quantity of a unit and what one of it is in SI.

    Symbols are read as SI writes them (``MV`` is no millivolt); where none of them fits, and for words, case does not
    matter.

    Parameters
    ----------
    unit : str
        Such as ``mV``, ``Volts``, ``Meters/Second^2``, ``m s⁻²``, ``[µm]``.

    Returns
    -------
    quantity : str
        ``voltage``, ``displacement``, ``velocity``, ``acceleration``, ``force``, ``time``, ``frequency``, ``pressure``,
        ``current``, ``temperature`` or ``count``.
    factor : float
        Of it, in SI; 1 for degrees Celsius and counts.

    Raises
    ------
    RigError
        If it cannot be read.

    Examples
    --------
    >>> si_factor("mm"), si_factor("g")
    (('displacement', 0.001), ('acceleration', 9.80665))
    >>> si_factor("µm") == si_factor("um") == si_factor("Mikrometer")
    True
    >>> si_factor("Volts"), si_factor("Meters/Second^2"), si_factor("MSEC")
    (('voltage', 1.0), ('acceleration', 1.0), ('time', 0.001))
    """
    text = _normal(unit)
    # What stands where no unit is known would else be newtons an ampere.
    found = None if text.casefold() in ("n/a", "na") else _read(text)
    if found is not None:
        powers = " ".join(
            base if power == 1 else f"{base}^{power}" for base, power in sorted(found[0].items()) if power
        )
        if powers in _QUANTITIES:
            return _QUANTITIES[powers], found[1]

    raise RigError(f"unit {unit!r} is not known: {nearest(text, [*UNITS, 'mV', 'mm', 'um', 'ms', 'm/s', 'm/s^2'])}")


def volts_per_unit(sensitivity: float, unit: str) -> tuple[str, float]:
    """Return what a sensor measures and its volts an SI unit.

    Parameters
    ----------
    sensitivity : float
        The number of the calibration sheet.
    unit : str
        Its unit, electrical over mechanical (``mV/g``, ``V/(m/s^2)``, ``V/mm``) or the inverse (``mm/V``).

    Returns
    -------
    quantity : str
        Such as ``displacement``.
    volts : float
        Volts an SI unit of it.

    Raises
    ------
    RigError
        If the unit is of another form or not known, or the number is not positive.

    Examples
    --------
    >>> quantity, volts = volts_per_unit(100.0, "mV/g")
    >>> quantity, round(volts, 9)
    ('acceleration', 0.010197162)
    >>> volts_per_unit(0.5, "mm/V")
    ('displacement', 2000.0)
    """
    if not sensitivity > 0 or sensitivity == float("inf"):
        raise RigError(f"sensitivity {sensitivity:g} {unit}: it must be a positive number; the sign has its own column")
    text = re.sub(r"\s+per\s+", "/", unit.strip(), flags=re.IGNORECASE)
    # The slash that parts the two is the first or the last outside of brackets and not the one inside m/s.
    for match in re.finditer("/", text):
        above, below = text[: match.start()], text[match.end() :]
        try:
            upper, lower = si_factor(above), si_factor(below)
        except RigError:
            continue
        if upper[0] == "voltage" and lower[0] != "voltage":
            return lower[0], sensitivity * upper[1] / lower[1]
        if lower[0] == "voltage" and upper[0] != "voltage":
            return upper[0], lower[1] / (sensitivity * upper[1])
    raise RigError(
        f"sensitivity unit {unit!r} is not one of volts over a mechanical unit or the inverse, such as mV/g, "
        "V/(m/s^2), V/mm, mm/V"
    )
