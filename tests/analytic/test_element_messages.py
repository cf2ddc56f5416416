"""OMM in its four forms against the TLE of the same elements."""

import json

import numpy as np
import pytest

from fieldline.errors import InputError
from fieldline.orbit import read_orbit

TLE = (
    "ISS (ZARYA)\n"
    "1 25544U 98067A   20097.82871450  .00000874  00000-0  24271-4 0  9992\n"
    "2 25544  51.6465 341.5807 0003880  94.4223  26.1197 15.48685836220958\n"
)
MESSAGE = {
    "OBJECT_NAME": "ISS (ZARYA)",
    "OBJECT_ID": "1998-067A",
    "EPOCH": "2020-04-06T19:53:20.932800",
    "MEAN_MOTION": 15.48685836,
    "ECCENTRICITY": 0.000388,
    "INCLINATION": 51.6465,
    "RA_OF_ASC_NODE": 341.5807,
    "ARG_OF_PERICENTER": 94.4223,
    "MEAN_ANOMALY": 26.1197,
    "EPHEMERIS_TYPE": 0,
    "CLASSIFICATION_TYPE": "U",
    "NORAD_CAT_ID": 25544,
    "ELEMENT_SET_NO": 999,
    "REV_AT_EPOCH": 22095,
    "BSTAR": 2.4271e-05,
    "MEAN_MOTION_DOT": 8.74e-06,
    "MEAN_MOTION_DDOT": 0,
}
META = {"CENTER_NAME": "EARTH", "REF_FRAME": "TEME", "TIME_SYSTEM": "UTC", "MEAN_ELEMENT_THEORY": "SGP4"}


def as_xml(message, spaces=""):
    leaves = "".join(f"<{key}>{value}</{key}>" for key, value in message.items())
    return f"<?xml version='1.0'?><ndm{spaces}><omm><body><segment><data>{leaves}</data></segment></body></omm></ndm>"


def as_kvn(message):
    return "CCSDS_OMM_VERS = 2.0\nCOMMENT of the day\nCREATION_DATE = 2020-04-07T00:00:00\n" + "".join(
        f"{key:20}= {value}{' [deg]' if key == 'INCLINATION' else ''}\n" for key, value in message.items()
    )


def as_csv(message):
    return ",".join(message) + "\n" + ",".join(str(value) for value in message.values()) + "\n"


FORMS = {
    "OMM JSON": lambda m: json.dumps([m]),
    "OMM JSON single": lambda m: json.dumps({key: str(value) for key, value in m.items()}, indent=1),
    "OMM XML": as_xml,
    "OMM XML namespace": lambda m: as_xml(m, " xmlns='urn:ccsds:recommendation:navigation:schema:ndmxml'"),
    "OMM KVN": as_kvn,
    "OMM CSV": as_csv,
}


def read(tmp_path, text, **options):
    file = tmp_path / "orbit"
    file.write_text(text)
    return read_orbit(file, **options)


@pytest.mark.parametrize("form", FORMS)
def test_every_form_gives_the_states_of_the_tle(tmp_path, form):
    orbit = read(tmp_path, FORMS[form](META | MESSAGE))
    assert (orbit.name, orbit.norad_id) == ("ISS (ZARYA)", 25544)
    assert form.startswith(orbit.kind)
    times = orbit.sets[0].epoch_utc + np.arange(100) * np.timedelta64(60, "s")
    expected = read(tmp_path, TLE).state_i(times)
    for mine, theirs in zip(orbit.state_i(times), expected, strict=True):
        assert np.abs(mine - theirs).max() < 1e-3


@pytest.mark.parametrize("form", ["OMM JSON", "OMM XML", "OMM KVN", "OMM CSV"])
@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"MEAN_MOTION": None}, "message 1|row 1.*MEAN_MOTION is missing"),
        ({"EPOCH": "yesterday"}, "EPOCH reads .yesterday."),
        ({"EPOCH": "2020-02-30T00:00:00"}, "EPOCH reads"),
        ({"INCLINATION": "steep"}, "INCLINATION reads .steep.*no number"),
        ({"ECCENTRICITY": 1.2}, "eccentricity.*within 0 and"),
        ({"ECCENTRICITY": "nan"}, "eccentricity.*within 0 and"),
        ({"REF_FRAME": "GCRF"}, "REF_FRAME is GCRF; SGP4 elements have TEME"),
        ({"MEAN_ELEMENT_THEORY": "DSST"}, "MEAN_ELEMENT_THEORY is DSST"),
        ({"EPHEMERIS_TYPE": 4}, "SGP4-XP"),
        ({"NORAD_CAT_ID": "ISS"}, "NORAD_CAT_ID reads"),
        ({"NORAD_CAT_ID": "-5"}, "not a catalogue number"),
    ],
)
def test_what_sgp4_cannot_carry_is_named(tmp_path, form, change, words):
    if form == "OMM CSV" and change == {"MEAN_MOTION": None}:
        words = "MEAN_MOTION is missing|holds no orbit"
    message = {key: value for key, value in (META | MESSAGE | change).items() if value is not None}
    with pytest.raises(InputError, match=words):
        read(tmp_path, FORMS[form](message))


def test_many_satellites_and_large_numbers(tmp_path):
    other = MESSAGE | {"NORAD_CAT_ID": 799501234, "OBJECT_NAME": "OBJECT X"}
    text = json.dumps([MESSAGE, other])
    with pytest.raises(InputError, match="2 satellites"):
        read(tmp_path, text)
    orbit = read(tmp_path, text, norad_id=799501234)
    assert orbit.name == "OBJECT X"
    assert np.isfinite(orbit.state_i(np.datetime64("2020-04-07"))[0]).all()
    two = as_kvn(MESSAGE) + as_kvn(MESSAGE | {"EPOCH": "2020-098T00:00:00Z"})
    assert [str(s.epoch_utc)[:19] for s in read(tmp_path, two).sets] == ["2020-04-06T19:53:20", "2020-04-07T00:00:00"]


@pytest.mark.parametrize(
    "text",
    [
        "[",
        "[]",
        "{}",
        "[1, 2]",
        '{"EPOCH": [1]}',
        "[" * 100000,
        '{"EPOCH": "2020-04-06T19:53:20", "MEAN_MOTION": 1' + "0" * 5000 + "}",
        "<omm>",
        "<omm/>",
        "<ndm/>",
        "<!DOCTYPE x [<!ENTITY a 'b'>]><omm>&a;</omm>",
        "CCSDS_OMM_VERS = 2.0\n",
        "CCSDS_OMM_VERS = 2.0\nEPOCH\n",
        "EPOCH,MEAN_MOTION\n",
        'EPOCH,MEAN_MOTION\n"',
    ],
)
def test_broken_messages_are_refused(tmp_path, text):
    with pytest.raises(InputError):
        read(tmp_path, text)
