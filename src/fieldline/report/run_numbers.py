"""The numbers of a run that a reader wants first: what flew, how it ended, rate, pointing, saturation, lines."""

from __future__ import annotations

from typing import Any

import numpy as np

from fieldline.report.pointing import pointing_of
from fieldline.report.run_record import DEG, RunRecord

AT_REST_DEG_S = 0.5  # a tumble is called stopped from where the rate stays below this
TUMBLING_DEG_S = 1.0
SETTLED_SHARE = 0.25  # of the run's end, over which pointing and rates are judged
FULL = 0.999  # of an actuator's limit
BRAKES = {"torquers", "eddy_currents", "hysteresis", "wheels", "thrusters"}


def run_numbers(dataset: Any) -> dict[str, Any]:
    """What `fieldline simulate --json` prints: plain numbers and words, a record for each body that turns and each line."""
    from fieldline.report.line_record import lines_of
    from fieldline.report.run_line_numbers import line_numbers

    record = RunRecord(dataset)
    return {
        "scenario": record.scenario.name,
        "complete": record.complete,
        "outcome": str(dataset.attrs.get("outcome", "")),
        "start_utc": np.datetime_as_string(record.time_utc[0], unit="s") + "Z",
        "duration_s": float(record.seconds[-1]),
        "samples": len(record.seconds),
        "bodies": {record.bodies[b]: _of_body(record, b) for b in record.rigid},
        "lines": {line.name: line_numbers(line) for line in lines_of(record)},
        "events": int(dataset.sizes.get("event", 0)),
    }


def _of_body(record: RunRecord, b: int) -> dict[str, Any]:
    """Rates, pointing and saturation of a body."""
    rate = np.linalg.norm(record.of("omega_bi_b", b, DEG), axis=1)
    last = slice(int((1.0 - SETTLED_SHARE) * len(rate)), None)
    numbers: dict[str, Any] = {"rate_start_deg_s": float(rate[0]), "rate_end_deg_s": float(rate[-1])}
    stopped = detumbled_after_s(record, rate)
    if stopped is not None:
        numbers["at_rest_after_s"] = stopped
    pointing = pointing_of(record, b)
    if pointing is not None:
        size = pointing.size_deg
        numbers["pointing"] = {
            "against": pointing.words,
            "rms_deg": float(np.sqrt(np.mean(size[last] ** 2))),
            "worst_deg": float(size[last].max()),
            "end_deg": float(size[-1]),
        }
    shares = saturation(record, b)
    if shares:
        numbers["saturated_share"] = shares
    return numbers


def detumbled_after_s(record: RunRecord, rate_deg_s: np.ndarray) -> float | None:
    """[s] from when the rate stays below `AT_REST_DEG_S`; None where nothing tumbled, or it never does, or nothing brakes."""
    brakes = BRAKES & {str(name) for name in record.dataset["load"].values}
    fast = np.flatnonzero(rate_deg_s >= AT_REST_DEG_S)
    if not brakes or rate_deg_s[0] < TUMBLING_DEG_S or fast[-1] + 1 >= len(rate_deg_s):
        return None
    return float(record.seconds[fast[-1] + 1])


def saturation(record: RunRecord, b: int) -> dict[str, float]:
    """Share of the outputs at which an actuator of body b stands at its limit, by kind, the worst of each kind."""
    shares = {}
    for kind, variable, words in (
        ("magnetorquer", "torquer_moment", "torquers"),
        ("wheel", "wheel_momentum", "wheels' momentum"),
        ("wheel", "wheel_torque", "wheels' torque"),
    ):
        names = record.names(kind, b)
        if names and record.has(variable):
            values = np.abs(record.dataset[variable].sel({kind: names}).values)
            shares[words] = float((values >= FULL * limits(record, b, variable)).mean(axis=0).max())
    return shares


def limits(record: RunRecord, b: int, variable: str) -> np.ndarray:
    """(n,) largest value of each actuator of body b."""
    body = record.scenario.body[b]
    if variable == "torquer_moment":
        return np.array([one.moment_max_a_m2 for one in body.magnetorquer])
    key = "momentum_max_n_m_s" if variable == "wheel_momentum" else "torque_max_n_m"
    return np.array([getattr(one, key) for one in body.wheel])
