"""Circuits of lines: which current each segment carries, by the circuit's kind.

    profile:  I_j = I(t) s(x_j)                           given, or commanded                             (1)
    series:   I_j = u I, equation (3) of `lines.current`                                                  (2)
    bare:     I_j = u I_j, `lines.bare`                                                                   (3)

u: part of full current, 1 unless a law commands it. It stands for a switch that is closed for that part of the time, so
powers go with u as well. What is reported as power is the load's; of a profile, what the field gives beyond the wire's own
loss, sum(emf_j I_j - R_j I_j^2), which is negative where a supply pushes against it.
"""

from __future__ import annotations

from fieldline.compiled import inner, kernel
from fieldline.dynamics.lines.bare import bare_currents
from fieldline.dynamics.lines.current import series_current, sphere_limit
from fieldline.dynamics.parameters import BARE, PROFILE, SERIES
from fieldline.environment.ephemeris import sun_kernel
from fieldline.environment.plasma import electron_density_kernel
from fieldline.frames.matrices import matvec
from fieldline.frames.vectors import norm, vec


@kernel
def between(x, places, values, first, last):
    """Linear interpolation in rows first .. last of a table, its ends' values held outside."""
    if x <= places[first]:
        return values[first]
    for k in range(first + 1, last):
        if x < places[k]:
            u = (x - places[k - 1]) / (places[k] - places[k - 1])
            return (1.0 - u) * values[k - 1] + u * values[k]
    return values[last - 1]


@kernel
def profile_current(t, x, k, circuits, command):
    """I [A] of equation (1) at the part x of line k's length."""
    current = command
    if circuits.commanded[k] == 0:
        current = between(t, circuits.times, circuits.currents, circuits.first_time[k], circuits.first_time[k + 1])
    if circuits.first_share[k + 1] > circuits.first_share[k]:
        current *= between(x, circuits.fractions, circuits.shares, circuits.first_share[k], circuits.first_share[k + 1])
    return current


@inner
def _profile(t, k, row, segments, circuits, command, ambient):
    """Currents of equation (1); the power that the field gives beyond the wire's loss."""
    whole = 0.0
    for s in range(row, row + segments):
        whole += ambient.length[s]
    along, power = 0.0, 0.0
    for s in range(row, row + segments):
        current = profile_current(t, (along + 0.5 * ambient.length[s]) / whole, k, circuits, command)
        ambient.current[s] = current
        power += current * (ambient.drive[s] - current * ambient.resistance[s])
        along += ambient.length[s]
    return power


@inner
def _series(k, row, segments, circuits, part, temperature_ev, ambient):
    """The one current of equation (2); the load's power."""
    drive, resistance = circuits.supply[k], circuits.load[k] + circuits.contactors[k]
    for s in range(row, row + segments):
        drive += ambient.drive[s]
        resistance += ambient.resistance[s]
    anode = 1 if drive > 0.0 else 0
    s = row + (segments - 1) * anode
    collected, potential = -1.0, 0.0
    if circuits.radius[k, anode] > 0.0:
        field = norm(vec(ambient.field_i, s))
        collected, potential = sphere_limit(
            circuits.radius[k, anode], ambient.electrons[s], field, temperature_ev, circuits.gain[k]
        )
    full = series_current(drive, resistance, collected, potential, circuits.emitted[k, 1 - anode])
    for s in range(row, row + segments):
        ambient.current[s] = part * full
    return part * circuits.load[k] * full * full


@inner
def _bare(k, row, segments, circuits, part, temperature_ev, ambient):
    """Currents of equation (3); the load's power."""
    ends = row + segments
    power, _ = bare_currents(
        ambient.drive[row:ends],
        ambient.resistance[row:ends],
        ambient.gather[row:ends],
        circuits.cathode_at_b[k] != 0,
        circuits.drop[k],
        circuits.load[k],
        temperature_ev,
        circuits.ion_mass[k],
        (ambient.cells, ambient.rows),
        ambient.current[row:ends],
    )
    for s in range(row, ends):
        ambient.current[s] *= part
    return part * power


@inner
def electrons_at(t, r_i, dcm_ei, surroundings):
    """Density of electrons [1/m^3] at a place."""
    sun_e = matvec(dcm_ei, sun_kernel(t, surroundings.ephemeris))
    return electron_density_kernel(matvec(dcm_ei, r_i), sun_e, surroundings.plasma)


@inner
def set_currents(t, k, row, segments, circuits, command, temperature_ev, ambient):
    """Currents of line k's segments, from row on, into `ambient`, which has their emf, resistance and plasma already."""
    kind = circuits.kind[k]
    if kind == PROFILE:
        ambient.power[k] = _profile(t, k, row, segments, circuits, command, ambient)
    elif kind == SERIES:
        ambient.power[k] = _series(k, row, segments, circuits, command, temperature_ev, ambient)
    elif kind == BARE:
        ambient.power[k] = _bare(k, row, segments, circuits, command, temperature_ev, ambient)
