"""Damaged orbit files, some thousand: a result or an InputError, never anything else, never a warning."""

import json

import numpy as np
import pytest

from fieldline.errors import InputError
from fieldline.frames.earth_orientation import read_eop
from fieldline.orbit import read_orbit
from fieldline.orbit.tle import checksum

TLE = b"""SUCHAI-3
1 52191U 22033AL  23236.44460393  .00026275  00000+0  73805-3 0  9994
2 52191  97.3614 318.0083 0006973 251.7714 108.2771 15.36489879 77757
1 52191U 22033AL  23247.77431173  .00022171  00000+0  61178-3 0  9997
2 52191  97.3601 329.3497 0007739 208.8387 151.2430 15.37072592 79491
"""
FIELDS = {
    "OBJECT_NAME": "SUCHAI-3",
    "EPOCH": "2023-08-24T10:40:13.779552",
    "MEAN_MOTION": 15.36489879,
    "ECCENTRICITY": 0.0006973,
    "INCLINATION": 97.3614,
    "RA_OF_ASC_NODE": 318.0083,
    "ARG_OF_PERICENTER": 251.7714,
    "MEAN_ANOMALY": 108.2771,
    "NORAD_CAT_ID": 52191,
    "BSTAR": 7.3805e-4,
    "MEAN_MOTION_DOT": 2.6275e-4,
}
XML = "<ndm><omm><data>" + "".join(f"<{k}>{v}</{k}>" for k, v in FIELDS.items()) + "</data></omm></ndm>"
OEM = """CCSDS_OEM_VERS = 2.0
META_START
OBJECT_NAME = SAT
OBJECT_ID = 2022-033AL
CENTER_NAME = EARTH
REF_FRAME = ITRF
TIME_SYSTEM = GPS
USEABLE_START_TIME = 2023-08-24T12:01:00
INTERPOLATION = HERMITE
INTERPOLATION_DEGREE = 7
META_STOP
2023-08-24T12:00:00.000 6850.0 0.0 0.0 0.0 -0.98 7.56
2023-08-24T12:01:00.000 6835.1 -58.7 453.4 -0.5 -0.97 7.55
2023-08-24T12:02:00.000 6790.4 -116.9 904.8 -1.0 -0.95 7.50
2023-08-24T12:03:00.000 6716.1 -174.1 1352.3 -1.5 -0.93 7.41
"""
EOP = """\
23 823 60179.00 I  0.291303 0.000028  0.429768 0.000017  I-0.0028166 0.0000112
23 824 60180.00 I  0.292564 0.000028  0.427255 0.000017  I-0.0021335 0.0000099
23 825 60181.00 I  0.294084 0.000028  0.424782 0.000017  I-0.0012577 0.0000106
"""
SEEDS = {
    "TLE": TLE,
    "JSON": json.dumps([FIELDS]).encode(),
    "XML": XML.encode(),
    "KVN": ("CCSDS_OMM_VERS = 2.0\n" + "".join(f"{k} = {v}\n" for k, v in FIELDS.items())).encode(),
    "CSV": (",".join(FIELDS) + "\n" + ",".join(map(str, FIELDS.values()))).encode(),
    "OEM": OEM.encode(),
}
TIMES = np.datetime64("2023-08-24T12:01:30") + np.arange(3) * np.timedelta64(20, "s")
ALPHABET = np.frombuffer(b' 0123456789+-.eE\n\r\t\0,;<>[]{}"=ABXYZinfa\xff\xc2\xb2', dtype=np.uint8)


def mutated(seed: bytes, rng) -> bytes:
    """One to four bytes changed, cut out, doubled, moved, or the end lost."""
    content = bytearray(seed)
    for _ in range(rng.integers(1, 5)):
        if not content:
            break
        at, span = int(rng.integers(len(content))), int(rng.integers(1, 12))
        match int(rng.integers(6)):
            case 0 | 1:
                content[at] = int(rng.choice(ALPHABET))
            case 2:
                del content[at : at + span]
            case 3:
                content[at:at] = content[at : at + span]
            case 4:
                content[at:at] = bytes(rng.choice(ALPHABET, span))
            case 5 if rng.random() < 0.2:
                del content[at:]
    return bytes(content)


def mended(content: bytes) -> bytes:
    """The same with checksums that fit, so that what lies behind them is reached."""
    lines = content.split(b"\n")
    for k, line in enumerate(lines):
        if len(line) == 69 and line[:1] in (b"1", b"2"):
            lines[k] = line[:68] + str(checksum(line.decode("latin-1"))).encode()
    return b"\n".join(lines)


def use(file) -> bool:
    """Whether the file gave an orbit; all but InputError passes through."""
    try:
        orbit = read_orbit(file)
        json.dumps(orbit.describe(TIMES[:0]))
        orbit.check(TIMES)
        position, velocity = orbit.state_i(TIMES)
        assert np.isfinite(position).all()
        assert np.isfinite(velocity).all()
        json.dumps(orbit.describe(TIMES))
    except InputError as error:
        assert str(error).isprintable()
        return False
    return True


@pytest.mark.parametrize(
    ("form", "count"), [("TLE", 3000), ("JSON", 700), ("XML", 700), ("KVN", 700), ("CSV", 700), ("OEM", 1200)]
)
def test_orbit_files(tmp_path, form, count):
    file = tmp_path / "orbit"
    rng = np.random.default_rng(sum(form.encode()))
    good = 0
    for k in range(count):
        content = mutated(SEEDS[form], rng)
        file.write_bytes(mended(content) if form == "TLE" and k % 2 else content)
        good += use(file)
    assert count * 0.01 < good < count * 0.95  # the mutations reach both sides


def test_eop_files(tmp_path):
    file = tmp_path / "eop"
    rng = np.random.default_rng(8)
    good = 0
    for _ in range(700):
        file.write_bytes(mutated(EOP.encode(), rng))
        try:
            eop = read_eop(file)
            assert np.isfinite(eop.ut1_minus_utc_s(TIMES)).all()
            good += 1
        except InputError as error:
            assert str(error).isprintable()
    assert 20 < good < 680
