"""The plant's line under uniform gravity against MoorDyn 2.7.2 (numbers and settings in moordyn_2_7_2.py and .csv).

Both lump half of each segment at either end and take the same stretch and damping, so that from the same nodes they must
move alike until rounding or the steps tell them apart.
"""

import csv
from pathlib import Path

import numpy as np
import pytest

import tether_flights as tf

RATE = 2.0 * np.pi / 5.0
MOVED = ((2.0 * RATE**2, 1.5 * RATE**2, 0.0), RATE)


def table(case):
    """{time: (places (p, 3), tensions at both ends)}."""
    found = {}
    with Path(__file__).with_name("moordyn_2_7_2.csv").open() as stream:
        for row in csv.DictReader(stream):
            if row["case"] == case:
                places, _ = found.setdefault(
                    float(row["t_s"]), ([], (float(row["tension_first_n"]), float(row["tension_last_n"])))
                )
                places.append([float(row[key]) for key in ("x_m", "y_m", "z_m")])
    return {t: (np.array(places), np.array(tension)) for t, (places, tension) in found.items()}


@pytest.mark.parametrize(
    "case, ends, step, metres, newtons",
    [
        ("pendulum", (None, 12.0), 2e-3, 5e-8, 2e-5),
        # MoorDyn moves the driven end in straight lines of 0.1 ms; ten times that is ten times as far off
        ("driven", (None, MOVED), 2e-3, 4e-6, 8e-3),
    ],
)
def test_a_line_moves_as_in_moordyn(case, ends, step, metres, newtons):
    told = table(case)
    flight = tf.laboratory(
        told[0.0][0], 100.0, ends=ends, seconds=10.0, output=1.0, step=step, kg_per_m=0.2, stiffness=2e4, damping=2e2
    )
    flight.fly()
    one = tf.points(flight)
    places = tf.in_laboratory(one)
    assert np.ptp(places[:, len(places[0]) // 2], axis=0).max() > 3.0  # it moves
    for t, (expected, tension) in told.items():
        if t > 0.0:
            k = round(t)
            assert np.abs(places[k] - expected).max() < metres
            assert np.abs(one.tension[k, [0, -1]] - tension).max() < newtons
