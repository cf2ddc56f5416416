"""What surrounds a satellite: the Earth's magnetic field, gravity, the air, the ionosphere, the Sun, the Earth's shadow."""

from fieldline.environment.atmosphere import atmosphere_model
from fieldline.environment.eclipse import eclipse
from fieldline.environment.field import field_gradient, field_rate, magnetic_field
from fieldline.environment.field_record import FieldModel
from fieldline.environment.field_registry import MAGNETIC_FIELDS, field_model
from fieldline.environment.gravity import gravity_acceleration, gravity_model
from fieldline.environment.plasma import electron_density, plasma_model
from fieldline.environment.sun import sun_direction_i, sun_position_i

__all__ = [
    "magnetic_field",
    "field_gradient",
    "field_rate",
    "field_model",
    "FieldModel",
    "MAGNETIC_FIELDS",
    "gravity_acceleration",
    "gravity_model",
    "atmosphere_model",
    "plasma_model",
    "electron_density",
    "sun_position_i",
    "sun_direction_i",
    "eclipse",
]
