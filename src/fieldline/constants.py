"""Every number with its unit and source; nothing else.

Sources: [IERS] IERS Conventions (2010), TN 36; [WGS84] NIMA TR8350.2 3rd ed.; [IGRF] Alken et al. (2021),
Earth Planets Space 73:49; [IAU] IAU 2012 B2 and 2015 B3; [CODATA] CODATA 2018.
"""

EARTH_GM_M3_S2 = 3.986004418e14  # [IERS] geocentric gravitational constant
EARTH_J2 = 1.0826359e-3  # [IERS] dynamical form factor
EARTH_EQUATORIAL_RADIUS_M = 6378136.6  # [IERS]
EARTH_ROTATION_RATE_RAD_S = 7.292115e-5  # [WGS84] nominal mean angular velocity
EARTH_ROTATION_ANGLE_TURNS_PER_DAY = 1.00273781191135448  # [IERS] equation (5.15), of UT1

WGS84_SEMI_MAJOR_AXIS_M = 6378137.0  # [WGS84]
WGS84_FLATTENING = 1.0 / 298.257223563  # [WGS84]

IGRF_REFERENCE_RADIUS_M = 6371200.0  # [IGRF] the sphere on which Gauss coefficients are given

MU0_OVER_4PI = 1.0e-7  # [CODATA] T m/A, true to 6e-10 since 2019
ELEMENTARY_CHARGE_C = 1.602176634e-19  # [CODATA] exact
ELECTRON_MASS_KG = 9.1093837015e-31  # [CODATA]
ATOMIC_MASS_KG = 1.66053906660e-27  # [CODATA] unified atomic mass unit
STEFAN_BOLTZMANN_W_M2_K4 = 5.670374419e-8  # [CODATA] exact, rounded
SOLAR_CONSTANT_W_M2 = 1361.0  # [IAU] nominal, at one astronomical unit

ASTRONOMICAL_UNIT_M = 149597870700.0  # [IAU]
SUN_RADIUS_M = 6.957e8  # [IAU] nominal
EARTH_MEAN_RADIUS_M = 6371008.8  # [WGS84] arithmetic mean

SECONDS_PER_DAY = 86400.0
