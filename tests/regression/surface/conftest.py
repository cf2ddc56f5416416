"""An estimate made by formula: a satellite that spins in a dipole's field, with everything a report can show."""

import json

import numpy as np
import pytest

EARTH_RATE = 7.292115e-5
RADIUS = 6.858e6


def spinning_estimate(samples=5600, step_s=1.0, rate_deg_s=(-9.0, -45.0, -2.0), extras=True, usable=True):
    """The Dataset of `estimate_attitude` for a made-up flight."""
    import xarray

    draw = np.random.default_rng(7)
    seconds = np.arange(samples) * step_s
    seconds = seconds[np.r_[: samples // 3, samples // 3 + min(14, samples // 10) : samples]] if samples > 30 else seconds
    n = len(seconds)
    time = np.datetime64("2023-08-24T14:44:09", "ns") + (seconds * 1e9).astype("timedelta64[ns]")
    position, velocity, latitude, longitude = circular_orbit(seconds)
    field_i = dipole(position)
    sun = np.array([-0.88, 0.43, 0.19])
    sunlit = 1.0 - ((position @ sun < 0) & (np.linalg.norm(np.cross(position, sun), axis=1) < 6.371e6))
    omega = np.radians(rate_deg_s)
    q = spin(seconds, omega)
    field_b = turn(q, field_i)
    residual = draw.normal(0, 6e-7, (n, 3))
    std = np.radians([2.0, 3.0, 1.8]) * (1.0 + 0.8 * np.cos(np.pi * seconds / seconds[-1]) ** 2)[:, None]
    axis = ["x", "y", "z"]
    vector = ("time", "axis")
    gain = 1.0 + 0.03 * np.sin(seconds / 900.0)
    bias = np.array([99.8e-6, -30.1e-6, -28.6e-6])
    data = {
        "q_bi": (("time", "quaternion"), q),
        "omega_bi_b": (vector, omega + draw.normal(0, 2e-4, (n, 3))),
        "attitude_std_b": (vector, std),
        "omega_std_b": (vector, np.full((n, 3), 4e-4)),
        "field_raw_s": (vector, (field_b + residual) / gain[:, None] + bias),
        "field_b": (vector, field_b + residual),
        "field_predicted_b": (vector, field_b),
        "residual_b": (vector, residual),
        "used": ("time", draw.random(n) > 0.01),
        "field_i": (vector, field_i),
        "position_i": (vector, position),
        "velocity_i": (vector, velocity),
        "latitude_deg": ("time", latitude),
        "longitude_deg": ("time", longitude),
        "altitude_m": ("time", np.linalg.norm(position, axis=1) - 6.371e6),
        "sun_i": (vector, np.broadcast_to(sun, (n, 3)).copy()),
        "sunlit": ("time", sunlit),
        "nis": ("time", draw.chisquare(3, n) / 3.0),
    }
    if extras:
        faces = ["-x", "-y", "-z"]
        sun_b = turn(q, data["sun_i"][1])
        data["slow_error_b"] = (vector, 3e-7 * np.sin(seconds / 700.0)[:, None] * [1.0, -0.5, 0.3])
        data["innovation_b"] = (vector, draw.normal(size=(n, 3)))
        data["gyro_b"] = (vector, omega + np.radians([0.4, -0.3, 0.2]) + draw.normal(0, 3e-3, (n, 3)))
        lit = np.maximum(-sun_b, 0) * sunlit[:, None]
        data["sun_sensor"] = (("time", "face"), 400 * lit * [1, 0.3, 1] + 20 + draw.normal(0, 6, (n, 3)))
    coords = {"time": time, "axis": axis, "quaternion": ["x", "y", "z", "w"]}
    if extras:
        coords["face"] = faces
    dataset = xarray.Dataset(data, coords=coords)
    dataset.attrs |= {"Conventions": "CF-1.8", "usable": int(usable), "verdict": verdict(usable)["sentence"]}
    dataset.attrs["verdict_json"] = json.dumps(verdict(usable, extras))
    dataset.attrs["provenance_json"] = json.dumps(PROVENANCE)
    return dataset


def circular_orbit(seconds, inclination=np.radians(97.4)):
    """Position and velocity in inertial axes, geocentric latitude and longitude [deg]."""
    n = np.sqrt(3.986e14 / RADIUS**3)
    u = n * seconds
    p = np.array([1.0, 0.0, 0.0])
    q = np.array([0.0, np.cos(inclination), np.sin(inclination)])
    position = RADIUS * (np.cos(u)[:, None] * p + np.sin(u)[:, None] * q)
    velocity = RADIUS * n * (-np.sin(u)[:, None] * p + np.cos(u)[:, None] * q)
    latitude = np.degrees(np.arcsin(position[:, 2] / RADIUS))
    longitude = np.degrees(np.arctan2(position[:, 1], position[:, 0]) - EARTH_RATE * seconds)
    return position, velocity, latitude, (longitude + 180) % 360 - 180


def dipole(position, moment=np.array([0.1, 0.15, -0.98]) * 7.7e22 * 1e-7):
    """The field of a dipole at the Earth's centre [T]."""
    r = np.linalg.norm(position, axis=1, keepdims=True)
    u = position / r
    return (3 * (u @ moment)[:, None] * u - moment) / r**3


def spin(seconds, omega):
    """Quaternions of a turn at a constant rate in body axes from a tilted start."""
    from scipy.spatial.transform import Rotation

    start = Rotation.from_quat([0.3, -0.2, 0.5, 0.79])
    return (start * Rotation.from_rotvec(seconds[:, None] * omega)).as_quat()


def turn(q, vector_i):
    """The vector in body axes."""
    from scipy.spatial.transform import Rotation

    return Rotation.from_quat(q).inv().apply(vector_i)


def verdict(usable=True, extras=True):
    """The keys of `verdict_json`."""
    judgement = [
        {
            "what": "rate about y against the gyro",
            "value": 0.31,
            "unit": "deg/s",
            "limit": 0.6,
            "passed": True,
            "words": "medians differ by 0.31 deg/s",
        },
        {
            "what": "sun-sensor hits on -x, -z",
            "value": 91.2,
            "unit": "%",
            "limit": 95,
            "passed": False,
            "words": "5,012 of 5,494 samples agree",
        },
    ]
    return {
        "usable": usable,
        "sentence": "Usable: attitude within 2 to 3 deg, rate within 0.02 deg/s, one candidate stands out."
        if usable
        else "Not usable: the arc is too short to see the rotation about the field.",
        "exit_code": 0 if usable else 1,
        "attitude_std_deg": [1.9, 2.9, 1.7],
        "rate_std_deg_s": [0.02, 0.018, 0.023],
        "residual_rms_nt": 1043.2,
        "consistency": {"nis_mean": 0.98, "nis_band": [0.95, 1.05], "whiteness": 1.1, "words": "consistent"},
        "calibration": {
            "model": "full+gain",
            "sentence": "The slow gain explains what nine parameters leave.",
            "bias_ut": [99.8, -30.1, -28.6],
            "bias_std_ut": [0.12, 0.09, 0.08],
            "matrix": [[1.01, 0.02, 0.0], [0.02, 0.97, -0.01], [0.0, -0.01, 1.03]],
            "matrix_std": [[0.001, 0.002, 0.001], [0.002, 0.001, 0.002], [0.001, 0.002, 0.001]],
            "parameters": [{"name": "gain_per_kelvin", "value": 1e-4, "std": 2e-5}],
            "rms_nt": 612.0,
            "gain_knots_s": list(np.linspace(0, 5600, 8)),
            "gain_values": [1.0, 1.02, 1.04, 1.01, 0.98, 0.97, 0.99, 1.0],
            "candidates": [
                {
                    "model": "bias",
                    "parameters": 3,
                    "rms_nt": 5100.0,
                    "held_out_rms_nt": 5200.0,
                    "criterion": 97000.0,
                    "chosen": False,
                    "why": "leaves 5,100 nT",
                },
                {
                    "model": "full",
                    "parameters": 9,
                    "rms_nt": 1960.0,
                    "held_out_rms_nt": 2100.0,
                    "criterion": 88000.0,
                    "chosen": False,
                    "why": "leaves 1,960 nT",
                },
                {
                    "model": "full+gain",
                    "parameters": 16,
                    "rms_nt": 612.0,
                    "held_out_rms_nt": 650.0,
                    "criterion": 71000.0,
                    "chosen": True,
                    "why": "best in cross-validation",
                },
            ],
        },
        "telemetry": {"lines": ["5,586 samples over 5,599 s", "14 missing seconds in 1 gap", "no spikes <script>"]},
        "orbit": {"kind": "TLE", "name": "52191", "epochs": ["2023-08-24T10:40:13Z"], "age_days": 0.2, "warnings": []},
        "field_model": {"name": "IGRF-14", "epoch": 2023.65, "degree": 13, "predictive": False},
        "candidates": [
            {
                "name": "spin +45.9 deg/s about -y",
                "kept": True,
                "log_likelihood": -4120.0,
                "residual_rms_nt": 1043.0,
                "words": "best",
            },
            {
                "name": "spin about +y, alias",
                "kept": False,
                "log_likelihood": -18230.0,
                "residual_rms_nt": 9800.0,
                "words": "residuals nine times the best's",
            },
        ],
        "judgement": judgement if extras else [],
        "warnings": ["the sun sensors disagree on 9 % of the samples"] if extras else [],
        "settings": {"model": "IGRF-14", "calibration": "auto", "use": [], "seed": 0},
    }


PROVENANCE = {
    "versions": {"fieldline": "0.1.0", "numpy": "2.0"},
    "inputs": {"telemetry": {"name": "flight.csv", "sha256": "ab" * 32}, "orbit": {"name": "sat.tle", "sha256": "cd" * 32}},
    "recognition": [{"column": "mag_x_nT", "quantity": "field", "axis": "x", "unit": "nT"}],
}


@pytest.fixture(scope="session")
def estimate():
    return spinning_estimate()


@pytest.fixture(scope="session")
def plain_estimate():
    return spinning_estimate(samples=400, step_s=10.0, rate_deg_s=(0.0, -0.06, 0.0), extras=False)


@pytest.fixture(scope="session")
def make_estimate():
    return spinning_estimate
