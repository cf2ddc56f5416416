"""Lawrence (1992): an electromagnetically controlled precision orbital tracking vehicle, AFIT/GA/ENY/92D-05.

vehicle           mass, inertia, poles and conductors of the tank with towers (appendix D)
linear_model      F, G, H of the frozen instant (chapter 4)
controllability   at instants of the orbit, with and without thruster, and which conductors may fail
failures          which conductors may fail, at which inclinations
lqr               standoff, R-BAR, V-BAR and Z-BAR (appendix E)
turning_field     the regulators on the field that turns: Floquet multipliers
field             the dipole and IGRF-14 in the target's axes (appendix A)
lost_field        where its parts vanish: the question of sections 4.1.3 and 6
transfer          the climb that sizes the vertical conductors (chapter 5)
flown             the vehicles on the full plant for a day, under the thesis's regulator and under mended ones
linear_range      where the linear equations hold, against the plant
docking_standards position, rate and angle at contact over many runs
orbit_change      height and inclination by scheduled current: averaged, flown, by the closed form

Axes h: x up, y along the velocity, z along the orbit's normal (the thesis's c). The field's angle is u - thetag - lambda:
argument of latitude, Greenwich's angle, longitude of the austral pole (-78.5, 111 deg).
"""

from fieldline.cases.afit_1992.approaches import lqr
from fieldline.cases.afit_1992.docking import docking_standards
from fieldline.cases.afit_1992.failures import failures
from fieldline.cases.afit_1992.field_in_orbit import field
from fieldline.cases.afit_1992.field_lost import lost_field
from fieldline.cases.afit_1992.flown import flown
from fieldline.cases.afit_1992.frozen_model import linear_model
from fieldline.cases.afit_1992.linear_range import linear_range
from fieldline.cases.afit_1992.orbit_change import orbit_change
from fieldline.cases.afit_1992.reach import controllability
from fieldline.cases.afit_1992.tank import vehicle
from fieldline.cases.afit_1992.transfer_orbit import transfer
from fieldline.cases.afit_1992.turning_field import turning_field

__all__ = [
    "vehicle",
    "linear_model",
    "controllability",
    "failures",
    "lqr",
    "turning_field",
    "field",
    "lost_field",
    "transfer",
    "flown",
    "linear_range",
    "docking_standards",
    "orbit_change",
]
