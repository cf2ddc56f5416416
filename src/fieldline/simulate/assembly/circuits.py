"""From the circuits of a scenario's lines to the plant's arrays."""

from __future__ import annotations

import numpy as np

from fieldline.dynamics.parameters import BARE, NO_CIRCUIT, PROFILE, SERIES, Circuits

KINDS = {"profile": PROFILE, "series": SERIES, "bare": BARE}


def circuits_of(scenario) -> Circuits:
    """One row a line."""
    circuits = [line.circuit for line in scenario.line]
    times = [_times(one) for one in circuits]
    shares = [(one.fractions, one.shares) if one else ((), ()) for one in circuits]
    return Circuits(
        kind=np.array([KINDS[one.mode] if one else NO_CIRCUIT for one in circuits], dtype=np.int64),
        commanded=np.array([one is not None and one.commanded for one in circuits], dtype=np.int64),
        resistance=_each(circuits, "resistance_ohm_per_m"),
        coefficient=_each(circuits, "temperature_coefficient_1_k"),
        reference=_each(circuits, "reference_temperature_k"),
        load=_each(circuits, "load_ohm"),
        contactors=_each(circuits, "contactor_ohm"),
        supply=_each(circuits, "supply_v"),
        radius=_pairs(circuits, "collector_radius_m"),
        gain=_each(circuits, "collector_gain"),
        emitted=_pairs(circuits, "emission_max_a"),
        cathode_at_b=np.array([one is not None and one.cathode == "to" for one in circuits], dtype=np.int64),
        drop=_each(circuits, "cathode_drop_v"),
        ion_mass=_each(circuits, "ion_mass_u"),
        first_time=_first(times),
        times=_joined(table[0] for table in times),
        currents=_joined(table[1] for table in times),
        first_share=_first(shares),
        fractions=_joined(table[0] for table in shares),
        shares=_joined(table[1] for table in shares),
    )


def told_at_first(scenario) -> np.ndarray:
    """(lines,) what each circuit is told until a law commands it: nothing where a law will, else full current."""
    return np.array([0.0 if line.circuit and line.circuit.commanded else 1.0 for line in scenario.line], dtype=float)


def command_limits(circuit) -> tuple[float, float]:
    """Least and largest command of a circuit."""
    return (-circuit.current_max_a, circuit.current_max_a) if circuit.mode == "profile" else (0.0, 1.0)


def _times(circuit) -> tuple:
    """A profile's table in time: one row for a constant current."""
    if circuit is None or circuit.mode != "profile" or circuit.commanded:
        return (), ()
    return (circuit.times_s, circuit.currents_a) if circuit.times_s else ((0.0,), (circuit.current_a,))


def _each(circuits, key: str) -> np.ndarray:
    """(lines,) of one key, zero without a circuit."""
    return np.array([getattr(one, key) if one else 0.0 for one in circuits], dtype=float)


def _pairs(circuits, key: str) -> np.ndarray:
    """(lines, 2) of one key."""
    return np.array([getattr(one, key) if one else (0.0, 0.0) for one in circuits], dtype=float).reshape(-1, 2)


def _first(tables) -> np.ndarray:
    """Where each line's rows start in the joined table."""
    return np.cumsum([0, *(len(table[0]) for table in tables)]).astype(np.int64)


def _joined(columns) -> np.ndarray:
    """Columns one after the other, also of no line."""
    return np.concatenate([np.zeros(0), *map(np.asarray, columns)]).astype(float)
