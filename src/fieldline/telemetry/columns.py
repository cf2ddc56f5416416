"""What a column is, by its name: quantity, axis, unit and the instrument it belongs to.

A name is read from its end: a unit (`_nT`, `[mG]`, `(deg/s)`, `_A_m2`), then an axis (`_x`, `X`, `.x`, `[0]`), and the
words that remain say the quantity. Words that make a column something else (a model, an estimate, a residual, a field
in north-east-down axes) win over words that make it a sensor.
"""

from __future__ import annotations

import re
from typing import NamedTuple

from fieldline.telemetry.units import UNITS_OF, Unit, find_unit


class Column(NamedTuple):
    """A recognised name. `group` is the name without axis and unit: columns of one instrument share it."""

    name: str
    quantity: str
    axis: str
    unit: Unit | None
    group: str
    words: frozenset[str] = frozenset()


# Quantity: the words that name it, in the order in which they win.
WORDS = {
    "temperature": "temp temperature temps",
    "wheel_speed": "wheel wheels rw rwa reactionwheel momentumwheel",
    "dipole_command": "dipole dipoles mtq mtqs torquer torquers magnetorquer torquerod torquerods mtr mtm_cmd magnetorquers",
    "sun_sensor": "css sun sunsensor sunsensors photodiode photodiodes pd ldr ss sunsens",
    "solar_current": "solar panel panels solarpanel array pv solarcell",
    "gyro": "gyro gyros gyr gyroscope gyrometer omega rate rates angvel angrate angularrate angularvelocity angular w",
    "magnetometer": "mag mags mgm mtm tam magnetometer magnetometers magn magneto bfield magnetic vfm b h fgm amr magfield",
}
# Words that make a column something other than a sensor's reading in the sensor's own axes.
_OTHER = set(
    "model modelled predicted pred igrf wmm chaos reference ref est estimate estimated ekf kf filter residual res std sigma "
    "stddev rms var variance cov flag flags quality status valid validity error err norm total magnitude abs nec ned enu "
    "eci gcrs gcrf ecef itrf itrs inertial orbital lvlh orbit target desired setpoint sp bias offset gain mode state health "
    "acc accel accelerometer acceleration quat quaternion q roll pitch yaw euler residue sim truth true counter index id "
    "voltage power battery gps vector d db delta diff aocs other correction corr offset".split()
)
_YAW = {"yaw", "angle", "measured", "body", "sensor"}  # an angle of the body, measured apart from the magnetometer
_RAW_ONLY = {"temperature", "solar_current", "wheel_speed"}  # quantities without axes
_AXIS_LETTERS = "xyz"
_ELEMENT = {"0": "x", "1": "y", "2": "z"}
_PLAIN = re.compile(r"[\s_.:/\\,;|\-+]+")


def split_unit(name: str) -> tuple[str, str]:
    """A name and the unit written in it: "magX [mG]" gives ("magX", "mG"), "bx_uT" gives ("bx", "uT")."""
    text = name.strip().strip("\"'")
    bracket = re.fullmatch(r"(.*?)[\s_.,]*[\[({]([^\[\](){}]*)[\])}]\s*", text)
    if bracket and bracket.group(1) and bracket.group(2).strip().lower() not in {*_AXIS_LETTERS, "0", "1", "2", ""}:
        return bracket.group(1), bracket.group(2).strip()
    slash = re.fullmatch(r"(.*\S)\s+/\s*(\S+)", text)
    if slash and _any_unit(slash.group(2)):
        return slash.group(1), slash.group(2)
    parts = re.split(r"([\s_./]+)", text)
    for size in (7, 5, 3, 1):  # up to four words with the signs between them: "_A_m2", "_deg_per_s"
        if len(parts) > size + 1 and _any_unit("".join(parts[-size:])):
            return "".join(parts[: -size - 1]), "".join(parts[-size:])
    glued = re.fullmatch(r"(.*[a-z][XYZ])(nT|uT|mG|dps)", text)
    return (glued.group(1), glued.group(2)) if glued else (text, "")


def _any_unit(text: str) -> bool:
    """Whether the text spells a unit of anything."""
    return any(find_unit(text, quantity) for quantity in UNITS_OF)


def words_of(name: str) -> list[str]:
    """The lower-case words of a name: at signs, at a change of case and before or after digits."""
    name = re.sub(
        r"\[\s*([012xyzXYZ])\s*\]$|\(\s*([xyzXYZ])\s*\)$", lambda m: "_" + _ELEMENT.get(m[1] or m[2], m[1] or m[2]), name
    )
    name = re.sub(r"([a-z0-9])([A-Z])", r"\1_\2", name)
    name = re.sub(r"([A-Z]{2,})([A-Z][a-z]{2,})", r"\1_\2", name)
    name = re.sub(r"(?<=[A-Za-z])(?=\d)|(?<=\d)(?=[A-Za-z])", "_", name)
    return [word for word in _PLAIN.split(name.lower()) if word]


def _known(word: str) -> bool:
    return any(word in spellings.split() for spellings in WORDS.values())


def split_axis(words: list[str]) -> tuple[str, list[str]]:
    """The axis among the words and the words without it: a word of its own, or the first or last letter of a known one."""
    for place in reversed(range(len(words))):
        if words[place] in tuple(_AXIS_LETTERS):
            return words[place], words[:place] + words[place + 1 :]
    for place in reversed(range(len(words))):
        word = words[place]
        for axis, rest in ((word[-1], word[:-1]), (word[0], word[1:])):
            if axis in _AXIS_LETTERS and _known(rest):
                return axis, [*words[:place], rest, *words[place + 1 :]]
    return "", words


def find_face(name: str) -> str:
    """The face of the body that a sun sensor looks from: "-x" of css_mx, css_-x, sun_nx, css_x_neg, cssX-; "" if none."""
    text = re.sub(r"([a-z0-9])([A-Z])", r"\1_\2", name).lower()
    end = r"(?:$|[_\s.\d])"
    for pattern, sign_at, axis_at in (
        (rf"(?:^|[_\s.])(minus|plus|neg|pos|m|p|n|\+|-)[_\s.]?([xyz]){end}", 1, 2),
        (rf"(?:^|[_\s.])([xyz])[_\s.]?(minus|plus|neg|pos|m|p|n|\+|-){end}", 2, 1),
        (rf"(?<=[a-z])(\+|-)([xyz]){end}", 1, 2),
    ):
        found = re.search(pattern, text)
        if found:
            return ("+" if found[sign_at] in {"plus", "pos", "p", "+"} else "-") + found[axis_at]
    return ""


def recognise(name: str, unit_given: str = "") -> Column | None:
    """What the column of this name is, or None. `unit_given` is a unit that the file states apart from the name."""
    stem, unit_text = split_unit(name)
    words = words_of(stem)
    sun = _sun_sensor(name, stem, words, unit_text or unit_given)
    if sun:
        return sun
    if "yaw" in words and set(words) <= _YAW and (unit := find_unit(unit_text or unit_given, "yaw")):
        return Column(name, "yaw", "", unit, "yaw", frozenset(words))
    axis, rest = split_axis(words)
    if set(rest) & _OTHER:
        return None
    quantity = next((q for q, spellings in WORDS.items() if set(rest) & set(spellings.split())), "")
    if not quantity or (quantity not in _RAW_ONLY and not axis) or quantity == "sun_sensor":
        return None
    if quantity == "solar_current" and not set(rest) & {"current", "curr", "i"}:
        return None
    if quantity == "wheel_speed" and not (set(rest) & {"speed", "rpm", "rate", "omega"} or find_unit(unit_text, quantity)):
        return None
    unit = find_unit(unit_text or unit_given, quantity)
    if unit is None and unit_text:
        return None  # a current of a magnetorquer, say: the unit is of another quantity
    return Column(name, quantity, axis, unit, "_".join(rest), frozenset(rest))


def _sun_sensor(name: str, stem: str, words: list[str], unit_text: str) -> Column | None:
    """A sun sensor on a named face; its number is a reading without a unit of its own."""
    sensor = set(words) & set(WORDS["sun_sensor"].split()) or re.match(r"css|sun", stem.lower())
    face = find_face(stem) if sensor else ""
    if not face or set(words) & (_OTHER | {"temp", "temperature"}):
        return None
    unit = find_unit(unit_text, "sun_sensor") or Unit("", 1.0)
    return Column(name, "sun_sensor", face, unit, "sun_sensor", frozenset(words))
