"""What surrounds the bodies: magnetic field, gravity, air, plasma, Earth rotation."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator

from fieldline.records import Record, RecordError
from fieldline.records.values import Vector
from fieldline.simulate.scenario.plasma import Plasma

NUMBERS = {
    "exponential": ("reference_density_kg_m3", "reference_altitude_km", "scale_height_km"),
    "msis": ("f107", "f107_average", "ap"),
}  # what each model of the air needs
Vectors = Annotated[tuple[Vector, ...], Field(strict=False)]


class Atmosphere(Record):
    """Density of the air, which turns with the Earth."""

    model: Literal["none", "exponential", "layered", "msis"] = Field(
        default="none",
        description='"exponential": one scale height; "layered": the standard table of scale heights by altitude; '
        '"msis": NRLMSIS 2.1 through pymsis, as a table made before the run',
    )
    reference_density_kg_m3: float | None = Field(
        default=None, gt=0.0, le=10.0, description="exponential: density at the reference altitude [kg/m^3]"
    )
    reference_altitude_km: float | None = Field(
        default=None, ge=0.0, le=10_000.0, description="exponential: altitude of that density, over WGS 84 [km]"
    )
    scale_height_km: float | None = Field(
        default=None, ge=1.0, le=1000.0, description="exponential: altitude over which the density falls by e [km]"
    )
    f107: float | None = Field(
        default=None, ge=65.0, le=300.0, description="msis: solar radio flux of the day before [1e-22 W/m^2/Hz]"
    )
    f107_average: float | None = Field(
        default=None, ge=65.0, le=300.0, description="msis: its mean over 81 days [1e-22 W/m^2/Hz]"
    )
    ap: float | None = Field(
        default=None, ge=0.0, le=400.0, description="msis: daily planetary index Ap, 4 quiet, 50 a storm [-]"
    )

    @model_validator(mode="after")
    def _parameters_fit(self):
        """A model has all of its numbers and none of another's."""
        found = []
        for model, keys in NUMBERS.items():
            for key in keys:
                given = getattr(self, key) is not None
                if model == self.model and not given:
                    found.append((key, f'is missing: model = "{model}" needs it'))
                if model != self.model and given:
                    found.append((key, f'has no meaning for model = "{self.model}"; leave it out, or choose "{model}"'))
        if found:
            raise RecordError(found)
        return self


class Environment(Record):
    """Magnetic field, gravity, air, plasma and Earth rotation."""

    field: str = Field(default="IGRF-14", min_length=1, description="name of the field model (`fieldline models` lists them)")
    field_degree: int | None = Field(default=None, ge=1, le=200, description="highest degree of its harmonics; all by default")
    field_order: int | None = Field(default=None, ge=0, le=200, description="highest order of its harmonics; all by default")
    field_until_year: float | None = Field(
        default=None, ge=1900.0, le=2100.0, description="carry the last secular variation on past the model's end, to this year"
    )
    field_moment_e_a_m2: Vectors | None = Field(
        default=None, description='dipoles of "centred-dipole" (one) or "displaced-dipoles" (several), ITRS axes [A m^2]'
    )
    field_position_e_m: Vectors | None = Field(default=None, description='places of "displaced-dipoles", ITRS axes [m]')
    uniform_field_i_tesla: Vector | None = Field(
        default=None, description="a constant field in GCRS axes instead of a model, for studies [T]"
    )
    gravity: Literal["point", "j2", "harmonic"] = Field(
        default="j2", description="a point mass, with the oblateness (J2), or with harmonics to gravity_degree"
    )
    gravity_degree: int | None = Field(
        default=None, ge=2, le=70, description='highest degree for gravity = "harmonic"; 20 by default'
    )
    gravity_gm_m3_s2: float | None = Field(
        default=None,
        ge=3.98e14,
        le=3.99e14,
        description="the Earth's gravitational parameter, for comparison with programs that used another [m^3/s^2]; orbits "
        "from elements keep the usual one",
    )
    atmosphere: Atmosphere = Field(default=Atmosphere(), description="density of the air, for drag")
    plasma: Plasma = Field(default=Plasma(), description="electrons of the ionosphere, for lines that collect current")
    earth_orientation: str | None = Field(
        default=None,
        min_length=1,
        description="file of measured Earth orientation (IERS finals2000A or C04); UT1 = UTC without it",
    )

    @model_validator(mode="after")
    def _fits_together(self):
        """One field, of options it has; a degree of gravity where it has harmonics."""
        found = []
        if self.gravity != "harmonic" and self.gravity_degree is not None:
            found.append(("gravity_degree", f'has no meaning for gravity = "{self.gravity}"; choose "harmonic"'))
        if self.gravity == "harmonic" and self.gravity_gm_m3_s2 is not None:
            found.append(
                ("gravity_gm_m3_s2", 'has no meaning for gravity = "harmonic", whose table brings its own; leave it out')
            )
        options = [key for key in type(self).model_fields if key.startswith("field_") and getattr(self, key) is not None]
        if self.uniform_field_i_tesla is not None:
            found += [(key, "has no meaning beside uniform_field_i_tesla; leave one of them out") for key in options]
            if not any(self.uniform_field_i_tesla):
                found.append(("uniform_field_i_tesla", "must not be zero; leave it out for a field model"))
            if max(map(abs, self.uniform_field_i_tesla)) > 1e-2:
                found.append(
                    ("uniform_field_i_tesla", "must be below 0.01 T; in low orbit the field is 2e-5 to 6e-5 T. Is it in nT?")
                )
        elif options or self.field != "IGRF-14":
            found += self._field_problems()
        if found:
            raise RecordError(found)
        return self

    def _field_problems(self) -> list[tuple[str, str]]:
        """What the field model itself refuses."""
        from fieldline.errors import InputError

        try:
            self.field_model()
        except InputError as error:
            return [("field", f"must be a field model with options that it has: {error}")]
        return []

    def field_model(self):
        """The chosen `FieldModel`, or None where the field is uniform."""
        from fieldline.environment.field_registry import field_model

        if self.uniform_field_i_tesla is not None:
            return None
        moment = self.field_moment_e_a_m2
        return field_model(
            self.field,
            degree=self.field_degree,
            order=self.field_order,
            until_year=self.field_until_year,
            moment_e=moment[0] if moment is not None and len(moment) == 1 and self.field_position_e_m is None else moment,
            position_e=self.field_position_e_m,
        )
