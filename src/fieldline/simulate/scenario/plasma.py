"""The ionosphere of a scenario, for lines that collect current."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator

from fieldline.errors import InputError
from fieldline.records import Record, RecordError

Numbers = Annotated[tuple[float, ...], Field(strict=False)]
MEANT_FOR = {
    "density_m3": ("constant",),
    "peak_day_m3": ("chapman",),
    "peak_night_m3": ("chapman",),
    "peak_day_altitude_km": ("chapman",),
    "peak_night_altitude_km": ("chapman",),
    "scale_below_km": ("chapman",),
    "scale_above_km": ("chapman",),
    "altitudes_km": ("table",),
    "day_m3": ("table",),
    "night_m3": ("table",),
}  # the models for which a key has a meaning


class Plasma(Record):
    """Density of the electrons of the ionosphere."""

    model: Literal["none", "constant", "chapman", "table"] = Field(
        default="none",
        description='"chapman": a layer that peaks at an altitude, by day and by night; "table": by altitude',
    )
    density_m3: float | None = Field(default=None, gt=0.0, description="constant: density of electrons [1/m^3]")
    peak_day_m3: float = Field(default=1e12, gt=0.0, description="chapman: density at the peak by day [1/m^3]")
    peak_night_m3: float = Field(default=1e11, gt=0.0, description="chapman: density at the peak by night [1/m^3]")
    peak_day_altitude_km: float = Field(default=300.0, gt=0.0, description="chapman: altitude of the peak by day [km]")
    peak_night_altitude_km: float = Field(default=350.0, gt=0.0, description="chapman: altitude of the peak by night [km]")
    scale_below_km: float = Field(default=50.0, gt=0.0, description="chapman: scale height below the peak [km]")
    scale_above_km: float = Field(
        default=100.0,
        gt=0.0,
        description="chapman: scale height above the peak; far above, the density falls by e in twice that [km]",
    )
    altitudes_km: Numbers = Field(default=(), description="table: rising altitudes over WGS 84 [km]")
    day_m3: Numbers = Field(default=(), description="table: densities there by day [1/m^3]")
    night_m3: Numbers = Field(default=(), description="table: densities there by night; as by day if not given [1/m^3]")
    temperature_ev: float = Field(
        default=0.1, gt=0.0, le=10.0, description="of the electrons, Boltzmann's constant times it [eV]"
    )

    @model_validator(mode="after")
    def _fits_together(self):
        """Keys of the chosen model only, and a model that can be made."""
        found = []
        for key, models in MEANT_FOR.items():
            if self.model not in models and getattr(self, key) != type(self).model_fields[key].default:
                found.append((key, f'has no meaning for model = "{self.model}"; leave it out'))
        if self.model == "constant" and self.density_m3 is None:
            found.append(("density_m3", 'is missing: model = "constant" needs it'))
        elif not found:
            try:
                self.made()
            except InputError as error:
                found.append(("", str(error)))
        if found:
            raise RecordError(found)
        return self

    def made(self):
        """The model as kernels take it."""
        from fieldline.environment.plasma import plasma_model

        return plasma_model(
            self.model,
            density_m3=self.density_m3 or 0.0,
            peak_day_m3=self.peak_day_m3,
            peak_night_m3=self.peak_night_m3,
            peak_height_day_m=1e3 * self.peak_day_altitude_km,
            peak_height_night_m=1e3 * self.peak_night_altitude_km,
            scale_below_m=1e3 * self.scale_below_km,
            scale_above_m=1e3 * self.scale_above_km,
            heights_m=[1e3 * altitude for altitude in self.altitudes_km],
            day_m3=self.day_m3,
            night_m3=self.night_m3,
            temperature_ev=self.temperature_ev,
        )
