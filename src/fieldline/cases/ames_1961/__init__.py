"""White, Shigemoto and Bourquin (1961): satellite attitude control utilizing the Earth's magnetic field, NASA TN D-1068.

field         the tilted, turning dipole along an orbit (figures 1 and 2)
pointing      a tracking line held by three coils or two (figure 5)
dump          wheels' momentum drawn out by coils; coils_against_jets
coil          the example of the Orbiting Astronomical Observatory
observatory   a day of its pointing, beyond the study
"""

from fieldline.cases.ames_1961.coil_example import coil
from fieldline.cases.ames_1961.dipole_field import across_field_eigenvalues, field, lines, lost_field
from fieldline.cases.ames_1961.line_pointing import pointing
from fieldline.cases.ames_1961.momentum_dump import coils_against_jets, dump
from fieldline.cases.ames_1961.observatory_day import observatory

__all__ = [
    "field",
    "lines",
    "lost_field",
    "across_field_eigenvalues",
    "pointing",
    "dump",
    "coils_against_jets",
    "coil",
    "observatory",
]
