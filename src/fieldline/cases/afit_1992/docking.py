"""Docking by current, many times: how near, how fast and how straight it meets its port, with what it does not know.

The template "docking" (a small satellite, 30 m from ahead, met at 5 mm/s), flown with navigation noise that differs from
run to run, a field that is not the model's by a factor, a mass that is not the believed one. What counts is the state at the
end of the commanded way, seen from the port.
"""

from __future__ import annotations

import numpy as np

from fieldline.cases.afit_1992.earth import SOURCE, whole
from fieldline.cases.ames_1961.dipole_field import settings_text
from fieldline.cases.erbs_like import number

QUANTITIES = (
    ("lateral_m", "m", "distance from the port's axis"),
    ("axial_m", "m", "distance along the axis from where it should be"),
    ("closing_rate_m_s", "m s-1", "rate along the axis, towards the port"),
    ("lateral_rate_m_s", "m s-1", "rate across the axis"),
    ("angle_deg", "degree", "angle of the body from the port's axes"),
    ("angular_rate_deg_s", "degree s-1", "angular rate against them"),
)
STATISTICS = ("mean", "std", "median", "p95", "worst")


def docking_standards(
    runs: int = 100,
    *,
    field_std: float = 0.1,
    mass_std: float = 0.05,
    position_noise_m: float = 0.02,
    velocity_noise_m_s: float = 0.0005,
    law: str = "tracking-allocated",
    seed: int = 1,
    workers: int | None = None,
):
    """The state at contact over many runs, as a Dataset over run, with a table over quantity and statistic.

    Parameters
    ----------
    runs : how many.      field_std, mass_std : relative errors of the believed field and mass, standard deviations.
    position_noise_m, velocity_noise_m_s : of the relative navigation, each second, each axis.      law : of the approach.
    seed, workers : as `simulate_many`.

    Returns
    -------
    Dataset: each quantity over run, table (quantity, statistic); field_factor and mass_kg drawn.
    """
    from fieldline.simulate import Normal, simulate_many
    from fieldline.simulate.scenario.scenario import Scenario
    from fieldline.simulate.scenario.templates import template

    settings = {key: value for key, value in locals().items() if key in ARGUMENTS}
    whole("runs", runs, 2, 100_000)
    for name in ("field_std", "mass_std", "position_noise_m", "velocity_noise_m_s"):
        number(name, settings[name], 0.0, 10.0)
    scenario = Scenario.from_toml(template("docking", "docking"))
    body, port = scenario.body[1], np.array(scenario.software[0].parameters["place_h_m"])
    known = {"mass_kg": body.mass_kg, "inertia_kg_m2": list(np.diag(np.array(body.inertia_kg_m2).reshape(3, 3)))}
    parameters = dict(scenario.software[0].parameters) | known
    scenario = scenario.replace(
        **{
            "time.output_step_s": 60.0,
            "body.1.navigation.relative_position_noise_std_m": position_noise_m,
            "body.1.navigation.relative_velocity_noise_std_m_s": velocity_noise_m_s,
            "software.0.law": law,
            "software.0.parameters": parameters,
        }
    )
    disperse = {
        "software.0.parameters.field_factor": Normal(1.0, field_std),
        "body.1.mass_kg": Normal(body.mass_kg, mass_std * body.mass_kg),
    }
    flown = simulate_many(scenario, runs, disperse=disperse, seed=seed, workers=workers)
    return _dataset(_contacts(flown, port), flown, settings)


ARGUMENTS = docking_standards.__code__.co_varnames[:8]


def _contacts(flown, port: np.ndarray) -> dict[str, np.ndarray]:
    """Each quantity over the runs, at the last output."""
    from scipy.spatial.transform import Rotation

    from fieldline.simulate.approach import relative_motion_h

    last = flown.isel(time=slice(-1, None)).stack(flight=("run", "time")).transpose("flight", ...)
    place, rate, dcm_hi = relative_motion_h(last, 1)
    off = place - port
    body = Rotation.from_quat(last["q_bi"].values[:, 1])
    turn = (Rotation.from_matrix(dcm_hi) * body).magnitude()
    r, v = last["position_i"].values[:, 0], last["velocity_i"].values[:, 0]
    spin = np.cross(r, v) / (r * r).sum(axis=1)[:, None]
    turning = np.linalg.norm(last["omega_bi_b"].values[:, 1] - body.inv().apply(spin), axis=1)
    values = (
        np.hypot(off[:, 0], off[:, 2]),
        off[:, 1],
        -rate[:, 1],
        np.hypot(rate[:, 0], rate[:, 2]),
        np.degrees(turn),
        np.degrees(turning),
    )
    return {name: value for (name, _, _), value in zip(QUANTITIES, values, strict=True)}


def _dataset(contacts: dict[str, np.ndarray], flown, settings: dict):
    """Each run's contact, and the table."""
    import xarray as xr

    rows = []
    for name, _, _ in QUANTITIES:
        one = contacts[name]
        size = np.abs(one - one.mean()) if name == "closing_rate_m_s" else np.abs(one)
        rows.append([one.mean(), one.std(), np.median(one), np.quantile(size, 0.95), size.max()])
    return xr.Dataset(
        {
            **{name: ("run", contacts[name], {"units": unit, "long_name": words}) for name, unit, words in QUANTITIES},
            "table": (
                ("quantity", "statistic"),
                np.array(rows),
                {"long_name": "p95 and worst: of sizes; of the rate, from its mean"},
            ),
        },
        coords={"run": flown["run"].values, "quantity": [name for name, _, _ in QUANTITIES], "statistic": list(STATISTICS)},
        attrs={
            "title": f"Docking by current: {settings['runs']} runs",
            "case": "afit_1992_docking",
            "source": f"after {SOURCE}, chapter 6: docking standards",
            "settings_json": settings_text(settings),
            "contacts": int(np.isfinite(contacts["lateral_m"]).sum()),
        },
    )
