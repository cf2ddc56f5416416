"""Scenarios to begin with: complete, commented, and each of a different kind of mission."""

from __future__ import annotations

from importlib.resources import files

from fieldline.errors import InputError, nearest

TEMPLATES = {
    "detumble": "a 3U CubeSat stops its tumble by B-dot",
    "picosatellite": "a picosatellite at 180 deg/s per axis, bang-bang torquers",
    "pointing": "a small satellite holds three axes by the field alone",
    "regulator": "the same by a periodic linear-quadratic regulator",
    "chain": "from tumbling to pointing, magnetometer and torquers alone",
    "wheels": "wheels point, torquers unload them",
    "dump": "torquers take the momentum out of wheels",
    "passive": "a magnet and hysteresis rods, no software",
    "observatory": "an observatory held on a star for a day",
    "pair": "two bodies on a line",
    "microsat-pair": "two microsatellites on a thin line of 500 m, swinging",
    "deploy": "a tether paid out to 20 km and taken in again by its tension",
    "tethered": "a satellite on a tether, steadied by moving the point at which it hangs",
    "skiprope": "a tether that skips, found by the satellite's magnetometer, taken out by a yaw",
    "tumble": "a free tumble with a magnetometer, for telemetry",
    "tss1r": "TSS-1R on station: 20 km of conducting tether, its current, heat and swing",
    "deorbit-tape": "a bare electrodynamic tape of 500 m brings a satellite down",
    "standoff": "a tank with towers stands beside a target by currents in its towers",
    "r-bar": "the same from above, slowly",
    "v-bar": "the same from ahead, along the track",
    "z-bar": "the same from the side, by prediction",
    "docking": "a small satellite with booms docks by currents",
    "boom-attitude": "its attitude alone, by currents",
    "orbit-change": "a tank with towers climbs by currents, less in the dark",
}


def template(name: str, scenario_name: str) -> str:
    """The text of a template with the scenario's name put in; InputError for an unknown one."""
    if name not in TEMPLATES:
        raise InputError(f'unknown template "{name}"; {nearest(name, TEMPLATES)}')
    text = files("fieldline").joinpath("data", f"scenario_{name}.toml").read_text(encoding="utf-8")
    from fieldline.simulate.scenario.toml import inline

    return text.replace('name = "NAME"', f"name = {inline(scenario_name)}", 1)
