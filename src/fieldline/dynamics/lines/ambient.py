"""What surrounds the segments of lines, taken anew every few seconds: field, air, plasma, light, and the current of it all.

For the middle of the interval to come, t + h, at the places where the points will be by then, p + h v: the field that a
line meets changes by 1e-3 a second along the orbit, so what is held departs by that times half an interval either way,
and not in the mean. Shape, speeds and temperatures stay live between: the force of a segment is I (p1 - p0) x B and
the drag of held density and live speed, at every stage of every step.
"""

from __future__ import annotations

import numpy as np

from fieldline.compiled import inner
from fieldline.dynamics.layout import NOTHING, feeds_at, nodes_at, temperatures_at, three
from fieldline.dynamics.lines.air import air_heating, segment_drag, wind_past
from fieldline.dynamics.lines.bare import bare_work, gathering
from fieldline.dynamics.lines.chain import attachment, line_end, unstretched
from fieldline.dynamics.lines.circuit import electrons_at, set_currents
from fieldline.dynamics.lines.current import segment_emf
from fieldline.dynamics.lines.heat import line_heating, warm_resistance
from fieldline.dynamics.parameters import NO_CIRCUIT, Ambient, Plant
from fieldline.dynamics.rates import field_at
from fieldline.environment.atmosphere import density_kernel
from fieldline.environment.ephemeris import dcm_ei_kernel, sun_kernel
from fieldline.environment.radiation import light_on_line
from fieldline.frames.matrices import matvec
from fieldline.frames.vectors import add, axpy, cross, put, scale, sub, unit, vec


def new_ambient(plant: Plant) -> Ambient:
    """Nothing around any line yet: no air, no current."""
    segments, lines = len(plant.lines.rest), len(plant.lines.nodes)
    longest = int(np.max(np.diff(plant.lines.first), initial=0)) + 1
    cells, rows = bare_work(longest)
    each, whole = np.zeros(segments), np.zeros(lines)
    return Ambient(
        field_i=np.zeros((segments, 3)),
        density=each.copy(),
        current=each.copy(),
        heating=each.copy(),
        drive=each.copy(),
        resistance=each.copy(),
        length=each.copy(),
        electrons=each.copy(),
        gather=each.copy(),
        chord_i=np.zeros((segments, 3)),
        emf=whole.copy(),
        power=whole.copy(),
        lorentz_i=np.zeros((lines, 3)),
        drag_i=np.zeros((lines, 3)),
        cells=cells,
        rows=rows,
        stale=np.zeros(1, dtype=np.int64),
    )


@inner
def meet(t, k, s, j, points, z, feed, warm, dcm_ei, plant, ambient):
    """All of segment s, number j of line k, that does not depend on the current; `points`: p0, v0, p1, v1 at t. Its drag."""
    lines, surroundings, circuits = plant.lines, plant.surroundings, plant.circuits
    p0, v0, p1, v1 = points
    middle, chord = scale(0.5, add(p0, p1)), sub(p1, p0)
    pole = (dcm_ei[6], dcm_ei[7], dcm_ei[8])
    wind = wind_past(p0, v0, p1, v1, pole)
    diameter = lines.diameter[s]
    put(ambient.chord_i, s, chord)
    ambient.length[s] = unstretched(j, k, z, feed, warm, lines)[0]
    drag = NOTHING
    if diameter > 0.0:
        sun_e = matvec(dcm_ei, sun_kernel(t, surroundings.ephemeris))
        ambient.density[s] = density_kernel(matvec(dcm_ei, middle), sun_e, t, surroundings.atmosphere)
        drag = segment_drag(p0, v0, p1, v1, pole, ambient.density[s], diameter, lines.drag_coefficient[s])
    if circuits.kind[k] != NO_CIRCUIT:
        field = field_at(middle, dcm_ei, surroundings)
        put(ambient.field_i, s, field)
        ambient.drive[s] = segment_emf(p0, v0, p1, v1, pole, field)
        ambient.electrons[s] = electrons_at(t, middle, dcm_ei, surroundings)
        ambient.gather[s] = gathering(diameter, ambient.electrons[s]) * ambient.length[s]
        warmth = z[warm + j] if warm >= 0 else circuits.reference[k]
        per_metre = warm_resistance(circuits.resistance[k], warmth, circuits.coefficient[k], circuits.reference[k])
        ambient.resistance[s] = per_metre * ambient.length[s]
    if warm >= 0:
        light, infrared = light_on_line(middle, unit(chord), sun_kernel(t, surroundings.ephemeris))
        air = air_heating(chord, wind, ambient.density[s], diameter)
        ambient.heating[s] = line_heating(light, infrared, air, 0.0, diameter, lines.absorptivity[k], lines.emissivity[k])
    return drag


@inner
def conduct(t, k, row, segments, warm, plant, inputs, ambient):
    """Currents of line k, their heat and their force."""
    temperature_ev = plant.surroundings.plasma.temperature_ev
    set_currents(t, k, row, segments, plant.circuits, inputs.circuit[k], temperature_ev, ambient)
    emf, force = 0.0, NOTHING
    for s in range(row, row + segments):
        current = ambient.current[s]
        emf += ambient.drive[s]
        force = axpy(current, cross(vec(ambient.chord_i, s), vec(ambient.field_i, s)), force)
        if warm >= 0:
            ambient.heating[s] += current * current * ambient.resistance[s] / ambient.length[s]
    ambient.emf[k] = emf
    put(ambient.lorentz_i, k, force)


@inner
def refresh_line(t, h, k, z, start, dcm_ei, plant, inputs, ambient):
    """What surrounds line k at t + h, as seen from the state z at t; dcm_ei: of t + h."""
    lines = plant.lines
    place_a, speed_a, _ = line_end(z, start, lines.body[k, 0], plant.bodies, *attachment(t, k, 0, plant, inputs))
    place_b, speed_b, _ = line_end(z, start, lines.body[k, 1], plant.bodies, *attachment(t, k, 1, plant, inputs))
    nodes, row = lines.nodes[k], lines.first[k] + k
    base, feed = nodes_at(plant) + 6 * lines.first[k], feeds_at(plant) + 2 * k
    warm = temperatures_at(plant) + lines.warm[k] if lines.warm[k + 1] > lines.warm[k] else -1
    p0, v0 = axpy(h, speed_a, place_a), speed_a
    drag = NOTHING
    for j in range(nodes + 1):
        v1 = three(z, base + 6 * j + 3) if j < nodes else speed_b
        p1 = axpy(h, v1, three(z, base + 6 * j) if j < nodes else place_b)
        drag = add(drag, meet(t + h, k, row + j, j, (p0, v0, p1, v1), z, feed, warm, dcm_ei, plant, ambient))
        p0, v0 = p1, v1
    put(ambient.drag_i, k, drag)
    if plant.circuits.kind[k] != NO_CIRCUIT:
        conduct(t + h, k, row, nodes + 1, warm, plant, inputs, ambient)


@inner
def refresh(t, h, z, start, plant, inputs, ambient):
    """Take anew what surrounds all lines that feel anything, for the time t + h, from the state z at t."""
    ambient.stale[0] = 0
    dcm_ei = dcm_ei_kernel(t + h, plant.surroundings.ephemeris)
    for k in range(plant.lines.nodes.shape[0]):
        if plant.lines.exposed[k] != 0 or plant.lines.warm[k + 1] > plant.lines.warm[k]:
            refresh_line(t, h, k, z, start, dcm_ei, plant, inputs, ambient)
