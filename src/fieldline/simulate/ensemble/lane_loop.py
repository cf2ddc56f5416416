"""The loop over a block of runs: readings, B-dot, events and outputs at their times, and `step_lanes` between them.

    M = clip(-k / |B|^2 (B(t) - B(t - T)) / T),   no moment before the second reading                       (1)

What the plant's loop does for the scenarios that `coverage` names, in its order: at each law call read the field, command,
keep an output where one is due; then the steps to the next call. A run whose rate falls through `rest_rate` has its time
by linear interpolation in the step; a block ends when all its runs have ended.
"""

from __future__ import annotations

from math import sqrt
from typing import NamedTuple

import numpy as np

from fieldline.environment.ephemeris import dcm_ei_kernel
from fieldline.frames.attitude import to_body
from fieldline.frames.matrices import matvec, transpose
from fieldline.frames.vectors import dot, scale, sub
from fieldline.simulate.ensemble.lanes import (
    LANES,
    Own,
    Scratch,
    Shared,
    field_lanes,
    lane3,
    lanewise,
    new_scratch,
    places_lanes,
    put3,
    step_lanes,
)
from fieldline.simulate.loop.records import Outcome

DONE, STOPPED = int(Outcome.DONE), int(Outcome.STOPPED)
NOT_FINITE, GROUND, COARSE = int(Outcome.NOT_FINITE), int(Outcome.GROUND), int(Outcome.COARSE)
COARSEST_TURN = 1.0  # [rad] of a step, as in the plant's loop
POLAR_RADIUS_M = 6356752.3


class Pace(NamedTuple):
    """When things happen, alike for all runs."""

    period: float  # [s] between law calls
    steps: int  # of the plant between two calls
    calls: int  # of the law until the end
    every: int  # law calls between two outputs
    rest_rate: float  # [rad/s] through which a rate must fall to end its run; 0: none does
    floor: float  # [m] height at which a run ends


class Progress(NamedTuple):
    """Where the block is, and what it leaves behind."""

    call: np.ndarray  # (1,) int64, law calls done
    before: np.ndarray  # 3 rows, the last reading [T], body axes
    moment: np.ndarray  # 3 rows [A m^2]
    rate: np.ndarray  # 1 row [rad/s], at the last step's end
    outcome: np.ndarray  # (LANES,) int64, 0 while a run goes on
    ended: np.ndarray  # (LANES,) [s]
    seconds: np.ndarray  # (outputs,)
    state: np.ndarray  # (LANES, outputs, 13); NaN after a run's end
    dipole: np.ndarray  # (LANES, outputs, 3) [A m^2]


@lanewise
def read_and_command(t, lanes, first, period, shared, own, s, progress):
    """Read the field at t and set the torquers by (1)."""
    dcm_ei = dcm_ei_kernel(t, shared.ephemeris)
    dcm_ie = transpose(dcm_ei)
    places_lanes(lanes, dcm_ei, s.z, s.place)
    field_lanes(lanes, s.place, shared.basis, shared.table, s.sums, s.field)
    for n in range(lanes):
        q = (s.start[n], s.start[LANES + n], s.start[2 * LANES + n], s.start[3 * LANES + n])
        field_b = to_body(q, matvec(dcm_ie, lane3(s.field, 0, n)))
        wanted = scale(-own.gain[n] / (period * dot(field_b, field_b)), sub(field_b, lane3(progress.before, 0, n)))
        put3(progress.before, 0, n, field_b)
        for j in range(3):
            limit = own.moment_max[j * LANES + n]
            progress.moment[j * LANES + n] = 0.0 if first else min(max(wanted[j], -limit), limit)


@lanewise
def keep_output(t, row, s, progress):
    """States and moments of the runs that still go on."""
    progress.seconds[row] = t
    for n in range(LANES):
        if progress.outcome[n] != 0:
            continue
        for j in range(6):
            progress.state[n, row, j] = s.z[j * LANES + n]
        for j in range(4):
            progress.state[n, row, 6 + j] = s.start[j * LANES + n]
        for j in range(3):
            progress.state[n, row, 10 + j] = s.z[(9 + j) * LANES + n]
            progress.dipole[n, row, j] = progress.moment[j * LANES + n]


@lanewise
def end_run(n, t, outcome, progress):
    """Note how and when a run ended, once."""
    if progress.outcome[n] == 0:
        progress.outcome[n] = outcome
        progress.ended[n] = t


@lanewise
def look(t, h, pace, s, progress):
    """After a step from t: runs at rest, and states without meaning."""
    for n in range(LANES):
        omega = lane3(s.z, 9, n)
        before, rate = progress.rate[n], sqrt(dot(omega, omega))
        progress.rate[n] = rate
        r = lane3(s.z, 0, n)
        height = sqrt(dot(r, r)) - POLAR_RADIUS_M
        if not (rate < 1e300 and height < 1e300):
            end_run(n, t + h, NOT_FINITE, progress)
        elif height < pace.floor:
            end_run(n, t + h, GROUND, progress)
        elif before >= pace.rest_rate and rate < pace.rest_rate:
            end_run(n, t + h * (before - pace.rest_rate) / (before - rate), STOPPED, progress)


@lanewise
def any_left(progress):
    """Does any run still go on?"""
    for n in range(LANES):
        if progress.outcome[n] == 0:
            return True
    return False


@lanewise
def refuse_coarse(t, h, progress):
    """End the runs that turn too far in a step of h; they are stopped, so that they harm no other lane."""
    for n in range(LANES):
        if progress.rate[n] * h > COARSEST_TURN:
            end_run(n, t, COARSE, progress)


@lanewise
def fly_lanes(budget, shared, own, pace, s, progress):
    """Fly a block on for at most `budget` law calls; whether it is at its end."""
    lanes = shared.lanes
    h = pace.period / pace.steps
    for _ in range(budget):
        call = progress.call[0]
        t = call * pace.period
        read_and_command(t, lanes, call == 0, pace.period, shared, own, s, progress)
        if call % pace.every == 0:
            keep_output(t, call // pace.every, s, progress)
        if call == pace.calls or not any_left(progress):
            for n in range(LANES):
                end_run(n, t, DONE, progress)
            return True
        for j in range(pace.steps):
            refuse_coarse(t + j * h, h, progress)
            step_lanes(t + j * h, h, progress.moment, shared, own, s)
            look(t + j * h, h, pace, s, progress)
        progress.call[0] = call + 1
    return False


class Block(NamedTuple):
    """A block of runs in flight."""

    shared: Shared
    own: Own
    pace: Pace
    scratch: Scratch
    progress: Progress


def rows_of(values) -> np.ndarray:
    """(runs, n) as flat rows of LANES numbers; the last run fills the lanes that are left over."""
    values = np.asarray(values, dtype=float).reshape(len(values), -1)
    filled = np.concatenate([values, np.repeat(values[-1:], LANES - len(values), axis=0)])
    return np.ascontiguousarray(filled.T).ravel()


def new_block(shared: Shared, own: Own, pace: Pace, states: np.ndarray) -> Block:
    """A block at its start, from states (runs, 13)."""
    scratch = new_scratch()
    sigma = np.zeros((len(states), 3))
    scratch.z[:] = rows_of(np.hstack([states[:, :6], sigma, states[:, 10:13]]))
    scratch.start[:] = rows_of(states[:, 6:10])
    outputs = pace.calls // pace.every + 1
    progress = Progress(
        call=np.zeros(1, dtype=np.int64),
        before=np.zeros(3 * LANES),
        moment=np.zeros(3 * LANES),
        rate=rows_of(np.linalg.norm(states[:, 10:13], axis=1)),
        outcome=np.zeros(LANES, dtype=np.int64),
        ended=np.full(LANES, np.nan),
        seconds=np.full(outputs, np.nan),
        state=np.full((LANES, outputs, 13), np.nan),
        dipole=np.full((LANES, outputs, 3), np.nan),
    )
    progress.outcome[len(states) :] = DONE  # lanes left over
    return Block(shared, own, pace, scratch, progress)
