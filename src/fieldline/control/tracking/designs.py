"""Gains of the tracking laws from what a person sets, the vehicle, and the field along its orbit."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from fieldline.control.controllable import THRESHOLD, controllability_now, words_of
from fieldline.control.frozen_regulator import frozen_regulator
from fieldline.control.law import Law, Parameter
from fieldline.control.periodic_system import (
    gains_before,
    held_gains,
    held_instants,
    held_problem,
    held_steps,
    instants_solution,
    periodic_solution,
    product,
)
from fieldline.control.tracking.by_instant import tracking_frozen
from fieldline.control.tracking.by_loads import tracking_allocated, tracking_periodic
from fieldline.control.tracking.by_prediction import MOST_CONTROLS, MOST_STAGES, PLAN_MEMORY, tracking_predictive
from fieldline.control.tracking.onboard_vehicle import REACH
from fieldline.control.tracking.orbit_change import LAWS as ORBIT_LAWS
from fieldline.control.tracking.settings import COMMON, WEIGHTS, Known, known_of, scale_of, state_weights
from fieldline.control.tracking.tracking_loop import MEMORY
from fieldline.errors import InputError, NoEstimateError
from fieldline.mechanics.relative_motion import STATES, output_matrix

REACH_SHARE = 0.6  # of the radial load, which the way along the track asks for by its rate
RETURNED = 1e-3  # margin from which a motion counts as within reach again
COMMANDS = ("thrust", "current")

FROZEN = {
    **COMMON,
    "instant_s": Parameter("s", "time after the start whose field the gain is made for", 0.0, "not negative"),
    "frozen_field_h_nt": Parameter(
        "nT", "field that the gain is made for instead, axes h; derived from instant_s", kind="vector", derived=True
    ),
    "state_weight": Parameter("", "weight of metres and metres per second; r0 times as much of angles", 1.0, "positive"),
    "control_weight": Parameter("", "weight of an ampere and a newton", 1.0, "positive"),
    "feed_forward": Parameter(
        "",
        "what holds the path: by the same instant, or by the field as it turns",
        "frozen",
        "choice",
        choices=("frozen", "turning"),
    ),
}
PREDICTIVE = {
    **COMMON,
    **WEIGHTS,
    "stages": Parameter("", f"stages of the horizon, up to {MOST_STAGES}", 30, "positive"),
    "stage_s": Parameter("s", "length of a stage", 90.0, "positive"),
    "most_steps": Parameter("", "exchanges of the solver in a call; 25 are never needed from a last plan", 25, "positive"),
}


def _pack_frozen(table, context) -> np.ndarray:
    known = known_of("tracking-frozen", FROZEN, table, context)
    values, n = known.values, known.mean_motion
    at = round(values["instant_s"] / known.step_s) % len(known.fields_h)
    G = known.inputs[at]
    if values["frozen_field_h_nt"] is not None:
        G = _inputs_in(known, context, 1e-9 * values["frozen_field_h_nt"])
    refuse_unreached(known, G, at)
    weights = values["state_weight"] * np.repeat([1.0, known.radius], 6)
    used = known.limits > 0.0
    found = frozen_regulator(
        known.motion, G[:, used], output_matrix(), weights, values["control_weight"], rate=n, scale=scale_of(known)
    )
    gain, prefilter = np.zeros((len(used), 12)), np.zeros((len(used), 6))
    gain[used], prefilter[used] = found.gain, found.prefilter
    turning = float(values["feed_forward"] == "turning")
    return np.concatenate([known.head, [turning], gain.ravel(), prefilter.ravel()])


def _inputs_in(known: Known, context, field_h) -> np.ndarray:
    """G (12, m) in one field [T]."""
    from fieldline.control.tracking.onboard_vehicle import controls_of
    from fieldline.control.tracking.settings import effects_of

    controls, _ = controls_of(context.conductors, context.thrusters, known.values["failed"])
    return known.pushes @ effects_of(controls, np.asarray(field_h, dtype=float)[None])[0]


def refuse_unreached(known: Known, G: np.ndarray, at: int) -> None:
    """InputError where a motion is out of reach of G (12, m): which, why, and when in the day it returns."""
    scales = {"rate": known.mean_motion, "scale": scale_of(known)}
    used = known.limits > 0.0
    now = controllability_now(known.motion, G[:, used], **scales)
    if now.margin > THRESHOLD:
        return
    later = controllability_now(known.motion, known.inputs[:, :, used], **scales).margin
    back = np.flatnonzero(np.roll(later, -at) > RETURNED)
    when = (
        f"its margin is back to {RETURNED:g} after {back[0] * known.step_s:.0f} s" if len(back) else "it does not return in a day"
    )
    loads = np.abs(G[1::2]).max(axis=1) * known.head[20:26]
    none = [name for name, load in zip(("x", "y", "z"), loads[:3], strict=True) if load <= 1e-9 * loads[:3].max()]
    why = f"no control pushes along {' or '.join(none)}" if none else "the arms of the controls and the field leave it out"
    raise InputError(
        f"no regulator of this instant: the motion in {words_of(now.motion, STATES)} cannot be reached (margin "
        f"{float(now.margin):.1e}), because {why}; {when}, as orbit and Earth turn on."
    )


def load_gain(known: Known, period_s: float) -> tuple[np.ndarray, np.ndarray]:
    """(K (6, 12), P (12, 12)) of the regulator of held loads, weighed by what all controls can give."""
    size = np.maximum(known.load_sizes, 1e-6 * known.load_sizes.max())
    scale, rate = scale_of(known), known.mean_motion
    F = known.motion * scale / scale[:, None] / rate
    G = known.pushes * size / scale[:, None] / rate
    kept = moved(known)
    gains, riccati = _solved(
        *_problem(F, G[None], state_weights(known) * scale * scale, kept), known.values["effort"], rate * period_s
    )
    K, P = np.zeros((6, 12)), np.zeros((12, 12))
    K[:, kept] = gains[0] * size[:, None] / scale[kept]
    P[np.ix_(kept, kept)] = riccati[0] / np.outer(scale[kept], scale[kept]) / rate
    return K, P


def reached(known: Known, gain: np.ndarray) -> np.ndarray:
    """The head with the error along the track that REACH_SHARE of the loads answers, by a gain (6, 12) of loads [m].

    Along the track alone: no place there pulls, so the body comes from afar at a constant rate. Upwards the orbit pulls away
    in proportion, and must be answered so; across it pulls back.
    """
    head = known.head.copy()
    if known.values["hold"] == "all":
        head[REACH + 1] = REACH_SHARE * known.load_sizes[0] / abs(gain[1, 2])
    return head


def moved(known: Known) -> np.ndarray:
    """The states that are controlled: all, or those of the attitude."""
    return np.arange(6 if known.values["hold"] == "attitude" else 0, 12)


def _problem(F, G, q, kept) -> tuple[bytes, bytes, bytes, tuple[int, int, int]]:
    """The scaled problem as what a cache can keep."""
    G = np.ascontiguousarray(G[:, kept])
    return np.ascontiguousarray(F[np.ix_(kept, kept)]).tobytes(), G.tobytes(), np.ascontiguousarray(q[kept]).tobytes(), G.shape


def _pack_allocated(table, context) -> np.ndarray:
    known = known_of("tracking-allocated", {**COMMON, **WEIGHTS}, table, context)
    gain, _ = load_gain(known, context.period_s)
    return np.concatenate([reached(known, gain), gain.ravel()])


def _pack_periodic(table, context) -> np.ndarray:
    known = known_of("tracking-periodic", {**COMMON, **WEIGHTS}, table, context)
    return _with_gains(known, periodic_gains(known), context)


def _pack_scheduled(table, context) -> np.ndarray:
    known = known_of("tracking-scheduled", {**COMMON, **WEIGHTS}, table, context)
    used = known.limits > 0.0
    margins = controllability_now(known.motion, known.inputs[:, :, used], rate=known.mean_motion, scale=scale_of(known)).margin
    worst = int(np.argmin(margins))
    refuse_unreached(known, known.inputs[worst], worst)
    return _with_gains(known, scheduled_gains(known), context)


def _with_gains(known: Known, gains: np.ndarray, context) -> np.ndarray:
    """The numbers of a law with a day's table of gains (N, m, 12)."""
    head = reached(known, load_gain(known, context.period_s)[0])
    return np.concatenate([head, [len(gains), known.step_s], gains.ravel()])


def periodic_gains(known: Known) -> np.ndarray:
    """(N, m, 12) gains of the periodic regulator over the day, controls weighed by their limits; kept, since it takes long."""
    return _over_the_day(known, lambda *given: _solved(*given)[0])


def scheduled_gains(known: Known) -> np.ndarray:
    """(N, m, 12) gains over the day, each of the regulator of its instant, for which the field stands still."""
    return _over_the_day(known, _of_instants)


def _over_the_day(known: Known, solved) -> np.ndarray:
    """(N, m, 12) gains in SI from a solution of the scaled problem."""
    used = known.limits > 0.0
    scale, rate = scale_of(known), known.mean_motion
    F = known.motion * scale / scale[:, None] / rate
    G = known.inputs[:, :, used] * known.limits[used] / scale[:, None] / rate
    kept = moved(known)
    problem = _problem(F, G, state_weights(known) * scale * scale, kept)
    found = solved(*problem, known.values["effort"], rate * known.step_s)
    gains = np.zeros((len(G), len(used), 12))
    gains[np.ix_(range(len(G)), np.flatnonzero(used), kept)] = found * known.limits[used][:, None] / scale[kept]
    return gains


def _ring(F: bytes, G: bytes, q: bytes, shape: tuple[int, int, int], effort: float):
    """(a, b, q, r) of the scaled problem, (N, ...) each."""
    count, n, m = shape
    a, weights = np.frombuffer(F).reshape(n, n), np.diag(np.frombuffer(q))
    a, weights, effort_m = (np.broadcast_to(one, (count, *one.shape)) for one in (a, weights, effort * np.eye(m)))
    return a, np.frombuffer(G).reshape(shape), weights, effort_m


@lru_cache(maxsize=8)
def _of_instants(F: bytes, G: bytes, q: bytes, shape: tuple[int, int, int], effort: float, step: float) -> np.ndarray:
    """Gains (N, m, n) of the scaled problem, each of its own instant."""
    held = held_instants(*_ring(F, G, q, shape, effort), step)
    steps, factor = held_steps(held)
    riccati, left = instants_solution(steps)
    if not (left < 1e-6).all():
        share = float((~(left < 1e-6)).mean())
        raise NoEstimateError(
            f"during {share:.1%} of the day no regulator of the instant keeps this vehicle: what the field lets its controls "
            'reach there is too little. "tracking-periodic" knows that it returns; a thruster is always there.'
        )
    return gains_before(held, riccati / factor)


@lru_cache(maxsize=8)
def _solved(
    F: bytes, G: bytes, q: bytes, shape: tuple[int, int, int], effort: float, step: float
) -> tuple[np.ndarray, np.ndarray]:
    """Gains (N, m, n) and P (N, n, n) of the scaled problem with inputs held over each step."""
    held = held_problem(*_ring(F, G, q, shape, effort), step * shape[0])
    steps, factor = held_steps(held)
    n = shape[1]
    riccati, closed, residual, doublings = periodic_solution(steps)
    values, vectors = np.linalg.eig(product(closed)) if doublings > 0 else (np.array([np.inf]), np.zeros((n, 1)))
    if doublings < 0 or residual > 1e-6 or not np.abs(values).max() < 1.0 - 1e-9:
        worst = words_of(vectors[:, np.abs(values).argmax()], STATES[12 - n :]) if doublings > 0 else ""
        lost = f"the motion in {worst} stays" if worst else "its equation does not settle"
        raise NoEstimateError(
            f"no periodic regulator keeps this vehicle: {lost}. No control reaches it at any time of the day, or too weakly; add "
            "a conductor in another direction or a thruster."
        )
    return held_gains(held, riccati / factor), riccati / factor


def _pack_predictive(table, context) -> np.ndarray:
    from scipy.linalg import expm

    known = known_of("tracking-predictive", PREDICTIVE, table, context)
    values, scale = known.values, scale_of(known)
    stages = _whole("stages", values["stages"], MOST_STAGES)
    m = len(known.limits)
    if m > MOST_CONTROLS:
        raise InputError(f'the law "tracking-predictive" takes up to {MOST_CONTROLS} controls; the body has {m}.')
    both = np.zeros((18, 18))
    both[:12, :12] = known.motion * scale / scale[:, None]
    both[:12, 12:] = known.pushes / scale[:, None]
    step = expm(both * values["stage_s"])
    _, P = load_gain(known, context.period_s)
    per_stage = values["stage_s"]
    Q = state_weights(known) * scale * scale * per_stage
    R = np.full(m, values["effort"] * per_stage)
    return np.concatenate(
        [
            known.head,
            [stages, per_stage, _whole("most_steps", values["most_steps"], 200), 0.0, 0.0],
            step[:12, :12].ravel(),
            step[:12, 12:].ravel(),
            Q,
            R,
            (P * np.outer(scale, scale)).ravel(),
            scale,
            [len(known.fields_h), known.step_s],
            (known.fields_h / known.values["field_factor"]).ravel(),
        ]
    )


def _whole(name: str, value: float, most: int) -> int:
    """A whole number from 1 to `most`."""
    if value != int(value) or not 1 <= value <= most:
        raise InputError(f'{name} of the law "tracking-predictive" must be a whole number from 1 to {most}; got {value:g}.')
    return int(value)


def _law(name, kernel, parameters, memory, doc, pack) -> Law:
    return Law(name, kernel, parameters, memory, COMMANDS, doc, pack, reference=True, optional=("thrust",))


LAWS = (
    _law(
        "tracking-frozen",
        tracking_frozen,
        FROZEN,
        MEMORY,
        "beside a target by currents, the regulator of an instant (1992)",
        _pack_frozen,
    ),
    _law(
        "tracking-allocated",
        tracking_allocated,
        {**COMMON, **WEIGHTS},
        MEMORY,
        "beside a target, loads allocated to currents and thrusters",
        _pack_allocated,
    ),
    _law(
        "tracking-scheduled",
        tracking_periodic,
        {**COMMON, **WEIGHTS},
        MEMORY,
        "beside a target, over the day each instant's own gain, within limits",
        _pack_scheduled,
    ),
    _law(
        "tracking-periodic",
        tracking_periodic,
        {**COMMON, **WEIGHTS},
        MEMORY,
        "beside a target, gains over the day, within limits",
        _pack_periodic,
    ),
    _law(
        "tracking-predictive",
        tracking_predictive,
        PREDICTIVE,
        PLAN_MEMORY,
        "beside a target, the best plan for the hour ahead",
        _pack_predictive,
    ),
    *ORBIT_LAWS,
)
