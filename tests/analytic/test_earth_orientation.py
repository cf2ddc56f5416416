"""Earth orientation files of the IERS: three days around the flown sample and a leap second.

Values: IERS, finals2000A (Rapid Service, Bulletin A) and EOP 20 C04, as served in September 2026; C04 of 2014's layout
has the same values without the hour.
"""

import numpy as np
import pytest

from fieldline.errors import InputError
from fieldline.frames.earth_orientation import ARCSECOND_RAD, leap_seconds, read_eop
from fieldline.frames.earth_rotation import dcm_ei

FINALS = """\
23 823 60179.00 I  0.291303 0.000028  0.429768 0.000017  I-0.0028166 0.0000112 -0.5988 0.0080  I     0.329    0.243
23 824 60180.00 I  0.292564 0.000028  0.427255 0.000017  I-0.0021335 0.0000099 -0.7800 0.0077  I     0.328    0.243
23 825 60181.00 I  0.294084 0.000028  0.424782 0.000017  I-0.0012577 0.0000106 -0.9579 0.0072  I     0.394    0.128
23 826 60182.00
"""
C04_20 = """\
# EARTH ORIENTATION PARAMETER (EOP) PRODUCT CENTER (PARIS OBSERVATORY)
# YR  MM  DD  HH       MJD        x(")        y(")  UT1-UTC(s)       dX(")      dY(")       xrt(")      yrt(")      LOD(s)
2023   8  23   0  60179.00    0.291370    0.429803  -0.0027933    0.000192   -0.000233    0.001506   -0.002500  -0.0006287
2023   8  24   0  60180.00    0.292535    0.427267  -0.0020899    0.000300   -0.000086    0.001531   -0.002638  -0.0007810
2023   8  25   0  60181.00    0.294166    0.424791  -0.0012425    0.000449    0.000071    0.001897   -0.002500  -0.0009207
"""
C04_14 = """\
        INTERNATIONAL EARTH ROTATION AND REFERENCE SYSTEMS SERVICE
                         EOP (IERS) 14 C04
2023   8  23  60179   0.291370   0.429803  -0.0027933  -0.0006287   0.000192  -0.000233
2023   8  24  60180   0.292535   0.427267  -0.0020899  -0.0007810   0.000300  -0.000086
2023   8  25  60181   0.294166   0.424791  -0.0012425  -0.0009207   0.000449   0.000071
"""
LEAP = """\
2016  12  31   0  57753.00    0.079766    0.261250  -0.4077697    0.000080    0.000010    0.0    0.0  0.0013000
2017   1   1   0  57754.00    0.078300    0.262490   0.5911600    0.000080    0.000010    0.0    0.0  0.0010000
"""
NOON = np.datetime64("2023-08-24T12:00:00")


def read(tmp_path, text):
    file = tmp_path / "eop.txt"
    file.write_text(text)
    return read_eop(file)


@pytest.mark.parametrize(("text", "ut1_utc", "x", "y"), [
    (FINALS, (-0.0021335 - 0.0012577) / 2, (0.292564 + 0.294084) / 2, (0.427255 + 0.424782) / 2),
    (C04_20, (-0.0020899 - 0.0012425) / 2, (0.292535 + 0.294166) / 2, (0.427267 + 0.424791) / 2),
    (C04_14, (-0.0020899 - 0.0012425) / 2, (0.292535 + 0.294166) / 2, (0.427267 + 0.424791) / 2),
], ids=["finals2000A", "C04 20", "C04 14"])  # fmt: skip
def test_three_layouts(tmp_path, text, ut1_utc, x, y):
    eop = read(tmp_path, text)
    assert len(eop.mjd) == 3
    assert eop.ut1_minus_utc_s(NOON) == pytest.approx(ut1_utc, abs=1e-12)
    assert np.array(eop.pole_rad(NOON)) / ARCSECOND_RAD == pytest.approx([x, y], abs=1e-12)


def test_a_leap_second_is_no_step_of_the_earth(tmp_path):
    eop = read(tmp_path, LEAP)
    before, after = np.datetime64("2016-12-31T23:59:59.999999"), np.datetime64("2017-01-01T00:00:00")
    assert eop.ut1_minus_utc_s(before) == pytest.approx(0.59116 - 1.0, abs=1e-6)
    assert eop.ut1_minus_utc_s(after) == pytest.approx(0.59116, abs=1e-9)


def test_leap_seconds():
    assert leap_seconds([41317.0, 57753.9, 57754.0, 60180.0]).tolist() == [10.0, 36.0, 37.0, 37.0]


def test_the_pole_moves_the_axis(tmp_path):
    """The Earth-fixed direction of the rotation axis is (x, -y): IERS Conventions (2010), s. 5.4.1."""
    eop = read(tmp_path, FINALS)
    axis_e = dcm_ei(NOON, eop) @ dcm_ei(NOON)[2]
    x, y = eop.pole_rad(NOON)
    assert axis_e[:2] == pytest.approx([x, -y], abs=1e-11)
    assert np.abs(dcm_ei(NOON, eop) @ dcm_ei(NOON, eop).T - np.eye(3)).max() < 1e-14


@pytest.mark.parametrize("time", ["2023-08-22T23:59:59", "2023-08-25T00:00:01"])
def test_outside_the_days_is_refused(tmp_path, time):
    with pytest.raises(InputError, match="covers 2023-08-23 to 2023-08-25"):
        dcm_ei(np.datetime64(time), read(tmp_path, FINALS))


@pytest.mark.parametrize(("text", "words"), [
    ("time,value\n1,2\n", "holds no Earth orientation: 0 days"),
    (FINALS.splitlines()[0], "1 days were found"),
    (FINALS.replace("0.427255", "0.42x255"), "line 2: MJD, pole x, pole y and UT1-UTC read .*not four numbers"),
    (FINALS.replace(" 0.427255", "60.427255"), "line 2: .*Have columns shifted"),
    (C04_20.replace("-0.0020899", "-2.0020899"), "cannot be a day's orientation"),
    (C04_20 + C04_20, "2023-08-23 comes after 2023-08-25"),
    (C04_14.replace("0.427267", "nan"), "cannot be a day's"),
    ("2023 8 24 60180\n2023 8 25 60181 \n", "not four numbers"),
    ("", "is empty"),
])  # fmt: skip
def test_malformed_files_are_named(tmp_path, text, words):
    with pytest.raises(InputError, match=words):
        read(tmp_path, text)
