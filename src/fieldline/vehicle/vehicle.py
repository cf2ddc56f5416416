"""A vehicle: mass, inertia, the loads that act on it and the actuators that it carries."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator

from fieldline.records import Record, RecordError
from fieldline.records.names import Name
from fieldline.records.values import ZEROS, Dissipative, Inertia, Symmetric, Vector
from fieldline.vehicle.conductor import Conductor
from fieldline.vehicle.hysteresis_rod import HysteresisRod
from fieldline.vehicle.magnetorquer import Magnetorquer
from fieldline.vehicle.surfaces import Drag, SolarPressure
from fieldline.vehicle.thruster import Thruster
from fieldline.vehicle.user_load import UserLoad
from fieldline.vehicle.wheel import Wheel

NONE = (0.0, 0.0, 0.0)
ROTATIONAL = (
    "inertia_kg_m2",
    "gravity_gradient",
    "residual_dipole_a_m2",
    "induced_dipole_a_m2_tesla",
    "eddy_damping_n_m_s_tesla2",
    "disturbance_torque_b_n_m",
    "disturbance_torque_i_n_m",
    "hysteresis_rod",
    "magnetorquer",
    "wheel",
    "conductor",
)  # what needs a body that turns
ACTUATORS = {"magnetorquer": "torquer", "wheel": "wheel", "thruster": "thruster", "conductor": "conductor"}


class Vehicle(Record):
    """A rigid body or a point mass, with its loads, each off until its key is given, and its actuators."""

    name: Name = Field(min_length=1, description="name of the body, unique in the scenario")
    kind: Literal["rigid", "point"] = Field(default="rigid", description="a rigid body with attitude, or a point mass")
    mass_kg: float = Field(gt=0.0, description="mass [kg]")
    inertia_kg_m2: Inertia | None = Field(
        default=None,
        description="inertia about the centre of mass, body axes [kg m^2]: three principal moments or a symmetric (3, 3) tensor "
        "with the products of inertia as it holds them; needed for a rigid body",
    )
    gravity_gradient: bool = Field(
        default=False, description="whether the Earth's pull, which falls off with height, turns the body"
    )
    residual_dipole_a_m2: Vector = Field(default=NONE, description="constant dipole, body axes [A m^2]")
    induced_dipole_a_m2_tesla: Symmetric = Field(
        default=ZEROS, description="dipole that the field induces in soft material, per field [A m^2/T]: a diagonal or (3, 3)"
    )
    eddy_damping_n_m_s_tesla2: Dissipative = Field(
        default=ZEROS,
        description="eddy currents: torque = field x (K (field x rate)), K [N m s/T^2] a diagonal or (3, 3), not negative",
    )
    disturbance_torque_b_n_m: Vector = Field(default=NONE, description="constant torque in body axes [N m]")
    disturbance_torque_i_n_m: Vector = Field(default=NONE, description="constant torque in inertial (GCRS) axes [N m]")
    drag: Drag | None = Field(default=None, description="aerodynamic drag; needs [environment.atmosphere]")
    solar_pressure: SolarPressure | None = Field(default=None, description="pressure of sunlight")
    hysteresis_rod: Annotated[tuple[HysteresisRod, ...], Field(strict=False)] = Field(default=(), description="hysteresis rods")
    magnetorquer: Annotated[tuple[Magnetorquer, ...], Field(strict=False)] = Field(default=(), description="magnetic torquers")
    wheel: Annotated[tuple[Wheel, ...], Field(strict=False)] = Field(default=(), description="reaction wheels")
    thruster: Annotated[tuple[Thruster, ...], Field(strict=False)] = Field(default=(), description="thrusters")
    conductor: Annotated[tuple[Conductor, ...], Field(strict=False)] = Field(
        default=(), description="straight conductors whose circuits close through the plasma"
    )
    load: Annotated[tuple[UserLoad, ...], Field(strict=False)] = Field(default=(), description="loads of the user's own")

    @model_validator(mode="after")
    def _one_kind(self):
        """A rigid body has an inertia; a point has nothing that turns it; actuators have names of their own."""
        found = list(self._misplaced()) + list(self._shared_names())
        if found:
            raise RecordError(found)
        return self

    def _misplaced(self):
        """What the kind of body asks for, or cannot have."""
        if self.kind == "rigid" and self.inertia_kg_m2 is None:
            yield "inertia_kg_m2", 'is missing: a rigid body needs it. Is the body meant as kind = "point"?'
        if self.kind == "point":
            for key in ROTATIONAL:
                if getattr(self, key) != type(self).model_fields[key].default:
                    yield key, 'has no meaning for kind = "point"; leave it out, or make the body kind = "rigid"'

    def _shared_names(self):
        """Actuators of one name."""
        for key in ACTUATORS:
            names = self.names_of(key)
            for k, name in enumerate(names):
                if name in names[:k]:
                    yield f"{key}[{k}].name", f'must be unique; "{name[:40]}" is the name of {key}[{names.index(name)}] too'

    def names_of(self, actuator: Literal["magnetorquer", "wheel", "thruster", "conductor"]) -> list[str]:
        """Names of the actuators of a kind, the given ones or torquer_1, wheel_1, thruster_1 and on."""
        return [one.name or f"{ACTUATORS[actuator]}_{k}" for k, one in enumerate(getattr(self, actuator), start=1)]
