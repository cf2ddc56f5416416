"""The law that changes an orbit by currents: its shadow, its contacts, what it refuses."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from fieldline.analysis.orbit_transfer import shadow_half_width
from fieldline.constants import EARTH_EQUATORIAL_RADIUS_M
from fieldline.control import LAWS
from fieldline.control.tracking.orbit_change import LIMITLESS, contact_limit
from fieldline.environment.eclipse import eclipse
from fieldline.environment.sun import sun_direction_i
from fieldline.errors import InputError
from law_tests import CARRIER, known_measurement

pytestmark = pytest.mark.kernels
LAW = LAWS["orbit-by-current"]
START = np.datetime64("2025-03-01T00:00:00")


def packed(**more):
    """The law's numbers for three conductors and a height far above."""
    return LAW.pack({"altitude_km": 900.0, **more}, CARRIER)


def test_the_shadow_is_the_cylinder_about_the_sun_as_it_goes_on():
    params = packed(contact_dark_a=3.0, sun_i=2.0 * sun_direction_i(START))
    rng = np.random.default_rng(4)
    places = rng.normal(size=(400, 3))
    places *= 6.9e6 / np.linalg.norm(places, axis=1)[:, None]
    seconds = rng.uniform(0.0, 20.0 * 86400.0, size=400)
    lit = eclipse(places, START + (1e9 * seconds).astype("timedelta64[ns]"), "cylinder")
    found = np.array([contact_limit(t, tuple(r), params) for t, r in zip(seconds, places, strict=True)])
    assert 0.2 < (lit == 0.0).mean() < 0.5
    assert ((found == 3.0) != (lit == 0.0)).sum() <= 3  # the Earth's orbit is no circle: 1 deg in 20 days
    assert set(np.unique(found)) == {3.0, LIMITLESS}


def test_the_part_of_an_orbit_in_the_shadow():
    a, u = 6.778e6, np.linspace(-np.pi, np.pi, 20_001)
    for height in (0.0, 0.6, 1.2, np.pi / 2.0):
        sun = np.array([-np.cos(height), 0.0, np.sin(height)])
        r = a * np.column_stack([np.cos(u), np.sin(u), 0.0 * u])
        dark = (r @ sun < 0.0) & (np.linalg.norm(np.cross(r, sun), axis=1) < EARTH_EQUATORIAL_RADIUS_M)
        assert_allclose(2.0 * shadow_half_width(a, height), 2.0 * np.pi * dark.mean(), atol=2e-3)


def test_contacts_in_the_dark_take_what_they_can():
    measurement = known_measurement()
    r = measurement.position_i / np.linalg.norm(measurement.position_i)
    told = [
        np.abs(LAW.kernel(0.0, measurement, np.zeros(LAW.memory), packed(**more)))
        for more in ({}, {"contact_dark_a": 0.25, "sun_i": r}, {"contact_dark_a": 0.25, "sun_i": -r})
    ]
    assert told[0].max() > 0.25
    assert_allclose(told[1], told[0])
    ratio = told[2] / told[0]
    assert told[2].max() <= 0.25 and np.ptp(ratio[told[0] > 0.0]) < 1e-12


@pytest.mark.parametrize(
    ("table", "words"),
    [
        ({"contact_dark_a": 1.0}, "belong together"),
        ({"sun_i": (1.0, 0.0, 0.0)}, "belong together"),
        ({"contact_dark_a": 1.0, "sun_i": (0.0, 0.0, 0.0)}, "a direction"),
        ({"contact_dark_a": -1.0, "sun_i": (1.0, 0.0, 0.0)}, "must not be negative"),
        ({"softness": 0.0}, "must be more than zero"),
    ],
)
def test_bad_input(table, words):
    with pytest.raises(InputError, match=words):
        packed(**table)
