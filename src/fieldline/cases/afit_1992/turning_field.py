"""The thesis's regulators on the field that turns: is the loop stable over an orbit, over a day?

    dx/dt = (F - G(t) K(t)) x,   x(t + T) = X(T) x(t),   stable if every eigenvalue of X(T) is inside the unit circle

Five gains: "frozen", K of one instant (33 degrees over the equator) kept for good, as in appendix E; "allocated", K of a
regulator of force and moment, which never changes, and the least controls that give them; "scheduled", the regulator of
each instant; "predictive", the first gain of a plan of 45 minutes in the field ahead, which is what the law of that name
comes to while no limit is active; "periodic", the regulator of the periodic system: over an equator in the time
2 pi/(n - we) in which the field's angle closes, elsewhere over a sidereal day, in which the orbit is taken to go round a
whole number of times (16 instead of 15.5). The commands are zero, the state is known.

The gains are made for the thesis's dipole. The truth may be another: the field times a factor, or IGRF-14.

Over the equator all are stable. At the design's own 28.5 degrees the frozen gain of the standoff is not: in a day its
state grows by e^79; the limit is between 14 and 17 degrees.
"""

from __future__ import annotations

import numpy as np

from fieldline.analysis.controllability import orbital_scale
from fieldline.analysis.margins import gain_range, held_delay
from fieldline.analysis.periodic_riccati import periodic_regulator
from fieldline.cases.afit_1992.approaches import APPROACHES, regulator_of
from fieldline.cases.afit_1992.earth import ALTITUDE_M, POLE_LONGITUDE_DEG, SOURCE, SPIN_RAD_S, Circle, circle
from fieldline.cases.afit_1992.frozen_model import built, frozen_plant
from fieldline.cases.ames_1961.dipole_field import settings_text
from fieldline.cases.erbs_like import number
from fieldline.control.electrodynamic import Plant, electrodynamic_map
from fieldline.control.frozen_regulator import frozen_regulator
from fieldline.control.periodic_system import continuous_instants, exponentials, instants_solution
from fieldline.control.tracking.plan_gains import plan_gains
from fieldline.environment.orbit_field import field_on_orbit_h
from fieldline.errors import InputError, NoEstimateError, nearest, shown
from fieldline.mechanics.relative_motion import input_matrix, output_matrix

CONTROLLERS = ("frozen", "allocated", "scheduled", "periodic", "predictive")
STAGES, STAGE_S = 30, 90.0  # of the law's horizon
TRUTHS = ("dipole", "IGRF-14")
MOST_STEPS = 20_000
SMALL_STEP = 0.02  # radians of the orbit, the first that is doubled
MOST_EFFORT = 1e4  # controls for the same loads, the dearest instant over the cheapest


def turning_field(
    case: str = "standoff",
    controller: str = "frozen",
    inclination_deg: float = 0.0,
    *,
    field_angle_deg: float = 33.0,
    duration_s: float | None = None,
    step_s: float = 20.0,
    altitude_m: float = ALTITUDE_M,
    field_scale: float = 1.0,
    truth: str = "dipole",
    margins: bool = False,
):
    """The transition of a closed loop over a turn of the field, or over a sidereal day, as a Dataset over `seconds`.

    Parameters
    ----------
    case : of appendix E; gives vehicle and weights.      controller : one of CONTROLLERS.
    inclination_deg : of the orbit; argument, node and Greenwich's angle are zero at the start.
    field_angle_deg : at which the frozen gain was made.      step_s : about; the duration is cut into equal steps.
    duration_s : a turn of the field's angle over the equator, a sidereal day elsewhere.
    field_scale : the true field over the one that the gains are made for.      truth : "dipole" or "IGRF-14" (1992).
    margins : of the loop over the duration too, for some seconds (`analysis.margins`).

    Returns
    -------
    Dataset: growth, the greatest real part of the frozen loop's poles [1/s] at each step; log_multiplier, the logarithm of the
    largest multiplier over the duration (negative: stable); unstable_share, of the time with growth; gain_norm. With `margins`
    gain_margin_low, gain_margin_high (factors on all controls, 0 to infinity, as far as the step resolves them) and
    delay_margin_s (in whole steps of controls that are held), not numbers where the loop is lost as it is.
    """
    settings = dict(locals())
    for name, value, known in (("case", case, APPROACHES), ("controller", controller, CONTROLLERS), ("truth", truth, TRUTHS)):
        if not isinstance(value, str) or value not in known:
            raise InputError(f'{name} "{shown(str(value))}" is unknown; {nearest(str(value), known)}')
    number("field_angle_deg", field_angle_deg, -1e6, 1e6)
    orbit = circle(altitude_m)
    turn = 2.0 * np.pi / (orbit.mean_motion_rad_s - SPIN_RAD_S)
    level = number("inclination_deg", inclination_deg, 0.0, 180.0) == 0.0
    if controller == "periodic" and duration_s is not None:
        raise InputError('controller = "periodic" has a period of its own; leave duration_s out.')
    number("field_scale", field_scale, 0.01, 100.0)
    length = number("duration_s", (turn if level else 2.0 * np.pi / SPIN_RAD_S) if duration_s is None else duration_s, 1.0, 1e7)
    count = int(np.ceil(length / number("step_s", step_s, 0.1, 600.0)))
    if count > MOST_STEPS:
        raise InputError(f"{length:g} s in steps of {step_s:g} are {count:,}; at most {MOST_STEPS:,}. Take a longer step.")
    halves = np.linspace(0.0, length, 2 * count + 1)
    whole_turns = controller == "periodic" and not level
    turning = round(orbit.mean_motion_rad_s / SPIN_RAD_S) * SPIN_RAD_S if whole_turns else orbit.mean_motion_rad_s
    plant, gains = _loop(case, controller, orbit, halves, turning, inclination_deg, field_angle_deg)
    return _dataset(_true_plant(plant, case, orbit, halves, turning, settings), gains, orbit, halves, settings)


def _true_plant(plant: Plant, case, orbit: Circle, halves, turning: float, settings: dict) -> Plant:
    """The plant in the true field."""
    own, scale = APPROACHES[case], settings["field_scale"]
    made = built({"vertical_m": own.towers_m[0], "horizontal_m": own.towers_m[1], "arms": "centre"})
    inputs = plant.G
    if settings["truth"] == "IGRF-14":
        node, inclination = -SPIN_RAD_S * halves, np.radians(settings["inclination_deg"])
        field_h = field_on_orbit_h(orbit.radius_m, inclination, turning * halves, node, np.datetime64("1992-12-01"))
        inputs = input_matrix(made.mass_kg, made.inertia_kg_m2, electrodynamic_map(made, field_h))
    wires = len(made.conductors)
    return plant._replace(G=np.concatenate([scale * inputs[..., :wires], inputs[..., wires:]], axis=-1))


def _loop(case, controller, orbit: Circle, halves, turning, inclination_deg, field_angle_deg) -> tuple[Plant, np.ndarray]:
    """The plant that is believed at nodes and midpoints, (2 N + 1, 12, m), and gains there, or one."""
    own = APPROACHES[case]
    made = built({"vertical_m": own.towers_m[0], "horizontal_m": own.towers_m[1], "arms": "centre"})
    node = -np.degrees(SPIN_RAD_S * halves) - POLE_LONGITUDE_DEG
    angle = np.degrees(turning * halves) + node
    plant, _ = frozen_plant(made, orbit, angle, inclination_deg, node)
    if controller == "frozen":
        here, _ = frozen_plant(made, orbit, field_angle_deg)
        return plant, regulator_of(here, orbit, own.state_weight).gain
    if controller == "allocated":
        return plant, _allocated_gains(plant, orbit, own.state_weight)
    n = orbit.mean_motion_rad_s
    if controller == "predictive":

        def ahead(seconds: float) -> np.ndarray:
            return frozen_plant(
                made,
                orbit,
                angle + np.degrees(turning - SPIN_RAD_S) * seconds,
                inclination_deg,
                node - np.degrees(SPIN_RAD_S) * seconds,
            )[0].G

        return plant, _predictive_gains(plant, ahead, orbit, own.state_weight)
    scale = orbital_scale(n)
    weights = np.diag(own.state_weight * np.repeat([1.0, orbit.radius_m], 6) * scale * scale)
    F, G = plant.F * scale / scale[:, None] / n, plant.G / scale[:, None] / n
    if controller == "scheduled":
        return plant, _scheduled_gains(F, G, weights) / scale
    found = periodic_regulator(F, G[:-1], weights, np.eye(G.shape[-1]), n * halves[-1], control="continuous")
    gains = found["gain"].values / scale
    return plant, np.concatenate([gains, gains[:1]])


def _scheduled_gains(F: np.ndarray, G: np.ndarray, weights: np.ndarray) -> np.ndarray:
    """(N, m, 12) of the scaled problem: the regulator of each instant, as if the field stood still from there on."""
    a, q = (np.broadcast_to(one, (len(G), 12, 12)) for one in (F, weights))
    steps, factor = continuous_instants(a, G @ np.swapaxes(G, 1, 2), q, SMALL_STEP)
    riccati, left = instants_solution(steps)
    if not (left < 1e-6).all():
        share = float((~(left < 1e-6)).mean())
        raise NoEstimateError(
            f"during {share:.1%} of the time no regulator of the instant was found: the field across the orbit vanishes there. "
            'Take "periodic", which knows that it returns.'
        )
    return np.swapaxes(G, 1, 2) @ riccati / factor


def _predictive_gains(plant: Plant, inputs_ahead, orbit: Circle, state_weight: float) -> np.ndarray:
    """(N, m, 12) of plans from each instant; inputs_ahead(seconds) (N, 12, m).

    What comes after a plan is weighed as the law does: by a regulator of accelerations at will, as large as all controls of one
    unit make them, RMS.
    """
    n, m = orbit.mean_motion_rad_s, plant.G.shape[-1]
    scale = orbital_scale(n)
    weights = state_weight * np.repeat([1.0, orbit.radius_m], 6)
    sizes = np.sqrt((np.abs(plant.G[:, 1::2]).sum(axis=2) ** 2).mean(axis=0))
    pushes = np.zeros((12, 6))
    pushes[1::2] = np.diag(np.maximum(sizes, 1e-6 * sizes.max()))
    after = frozen_regulator(plant.F, pushes, output_matrix(), weights, np.ones(6), rate=n, scale=scale).riccati
    length = n * STAGE_S
    both = np.zeros((1, 24, 24))
    both[0, :12, :12], both[0, :12, 12:] = length * plant.F * scale / scale[:, None] / n, length * np.eye(12)
    step = exponentials(both)[0]

    def inputs_of(stage: int) -> np.ndarray:
        G = plant.G if stage == 0 else inputs_ahead((stage + 0.5) * STAGE_S)
        return step[:12, 12:] @ (G / scale[:, None] / n)

    ahead = after * np.outer(scale, scale) * n
    gains = plan_gains(step[:12, :12], inputs_of, length * weights * scale * scale, np.full(m, length), ahead, STAGES)
    return gains / scale


def _allocated_gains(plant: Plant, orbit: Circle, state_weight: float) -> np.ndarray:
    """(N, m, 12) least controls for the accelerations of one regulator, weighed by the square of those controls, day's mean."""
    n = orbit.mean_motion_rad_s
    scale = orbital_scale(n)
    inverse = np.linalg.pinv(plant.G[:, 1::2] / scale[1::2, None])
    if not np.linalg.norm(inverse, axis=(1, 2)).max() < MOST_EFFORT * np.linalg.norm(inverse, axis=(1, 2)).min():
        raise InputError(
            'controller = "allocated" wants any force and moment at any time, and the field across the orbit vanishes at this '
            'inclination; take "periodic".'
        )
    root = np.linalg.cholesky((np.swapaxes(inverse, 1, 2) @ inverse).mean(axis=0)).T  # R = root' root of the accelerations
    pushes = np.zeros((12, 6))
    pushes[1::2] = np.diag(scale[1::2])
    weights = state_weight * np.repeat([1.0, orbit.radius_m], 6)
    inputs = pushes @ np.linalg.inv(root)
    found = frozen_regulator(plant.F, inputs, output_matrix(), weights, np.ones(6), rate=n, scale=scale)
    return inverse @ (np.linalg.inv(root) @ found.gain)


def log_multiplier(closed: np.ndarray, step_s: float) -> float:
    """Logarithm of the largest eigenvalue's size of the transition of closed (2 N + 1, n, n), nodes and midpoints [1/s].

    Infinite where a step alone grows beyond numbers, as with gains that peak.
    """
    start, middle, end = closed[:-1:2], closed[1::2], closed[2::2]
    bend = start @ end - end @ start
    exponents = step_s / 6.0 * (start + 4.0 * middle + end) - step_s**2 / 12.0 * bend  # Magnus, fourth order
    with np.errstate(over="ignore", invalid="ignore"):
        steps = exponentials(exponents)
    if not np.isfinite(steps).all():
        return np.inf
    whole, size = np.eye(closed.shape[-1]), 0.0
    for step in steps:
        whole = step @ whole
        norm = float(np.abs(whole).max())
        whole, size = whole / norm, size + float(np.log(norm))
    return size + float(np.log(np.abs(np.linalg.eigvals(whole)).max()))


def _margins(plant: Plant, gains: np.ndarray, scale: np.ndarray, halves: np.ndarray, verdict: float) -> dict[str, tuple]:
    """What the loop over the duration forgives: a factor on all controls, and a delay where they are held over each step."""
    F, G, K = plant.F * scale / scale[:, None], plant.G / scale[:, None], gains * scale
    step = float(halves[2])
    low, high, delay = np.nan, np.nan, np.nan
    if verdict < 0.0:
        low, high = gain_range(lambda factor: log_multiplier(F - factor * (G @ K), step) < 0.0)
        both = np.zeros((1, 24, 24))
        both[0, :12, :12], both[0, :12, 12:] = step * F, step * np.eye(12)
        passed = exponentials(both)[0]
        count = len(halves) // 2
        held = K[:-1:2] if K.ndim == 3 else np.broadcast_to(K, (count, *K.shape))
        delay = held_delay(np.broadcast_to(passed[:12, :12], (count, 12, 12)), passed[:12, 12:] @ G[1::2], held, step)
    return {
        "gain_margin_low": (low, "least factor on all controls that leaves the loop stable"),
        "gain_margin_high": (high, "largest factor on all controls that does"),
        "delay_margin_s": (delay, "longest delay of all controls, in whole steps, that does"),
    }


def _dataset(plant: Plant, gains: np.ndarray, orbit: Circle, halves: np.ndarray, settings: dict):
    """The verdict and how it comes about."""
    import xarray as xr

    scale = orbital_scale(orbit.mean_motion_rad_s)  # numbers of one size: the multipliers stay
    closed = (plant.F - plant.G @ gains) * scale / scale[:, None]
    growth = np.linalg.eigvals(closed[:-1:2]).real.max(axis=1)
    norms = np.broadcast_to(np.linalg.norm(gains, axis=(-2, -1)), halves.shape)[:-1:2]
    verdict = log_multiplier(closed, halves[2])
    scalars = {
        "log_multiplier": (verdict, "logarithm of the largest multiplier over the duration; negative: stable"),
        "unstable_share": (float((growth > 0.0).mean()), "share of the time in which the loop of the instant is unstable"),
    }
    if settings["margins"]:
        scalars |= _margins(plant, gains, scale, halves, verdict)
    return xr.Dataset(
        {
            "growth": ("seconds", growth, {"units": "s-1", "long_name": "greatest real part of the instant's poles"}),
            "gain_norm": ("seconds", norms, {"units": "1", "long_name": "Frobenius norm of the gain, SI"}),
            **{
                name: ((), value, {"units": "s" if name.endswith("_s") else "1", "long_name": words})
                for name, (value, words) in scalars.items()
            },
        },
        coords={"seconds": ("seconds", halves[:-1:2], {"units": "s"})},
        attrs={
            "title": f"{settings['case']}, {settings['controller']} gain, {settings['inclination_deg']:g} deg: "
            + ("stable" if verdict < 0.0 else "unstable"),
            "case": "afit_1992_turning_field",
            "source": f"{SOURCE}, section 4.2 and chapter 6",
            "settings_json": settings_text(settings),
            "duration_s": float(halves[-1]),
        },
    )
