"""How the motion is integrated between the times at which sensors are read and commands change."""

from __future__ import annotations

from typing import Literal

from pydantic import Field, model_validator

from fieldline.records import Record, RecordError


class Integrator(Record):
    """Runge-Kutta of a fixed step; Dormand-Prince 8(5,3), or a method implicit in stiff lines, of an error tolerance."""

    method: Literal["rk4", "dop853", "rosenbrock"] = Field(
        default="rk4",
        description='"rk4": fourth order, fixed step; "dop853": eighth order, step chosen by the error; "rosenbrock": third '
        "order, implicit in what stretches lines, so that their stiffness does not bind the step, which the error chooses",
    )
    step_s: float = Field(
        default=1.0, gt=0.0, description="step of rk4, first trial of the others [s]; steps also end at each reading and command"
    )
    step_max_s: float | None = Field(
        default=None, gt=0.0, description="largest step of dop853 and rosenbrock [s]; no limit by default"
    )
    relative_tolerance: float | None = Field(
        default=None,
        ge=1e-14,
        le=1e-2,
        description="error of a step over the state, which holds the distance from the Earth's centre; by default 1e-9 for "
        "dop853, 1e-12 for rosenbrock, less where its position_tolerance_m by default asks for it [-]",
    )
    position_tolerance_m: float | None = Field(
        default=None,
        gt=0.0,
        description="error of a step in position [m]; by default 1e-3 for dop853; for rosenbrock 1e-4, or a "
        "hundredth of what the stiffest segment of a line is stretched by at rest if that is less, but 1e-7 at least",
    )
    velocity_tolerance_m_s: float = Field(
        default=1e-6, gt=0.0, description="error of a step in velocity; rosenbrock also allows position_tolerance_m a step [m/s]"
    )
    angle_tolerance_rad: float | None = Field(
        default=None, gt=0.0, description="error of a step in attitude [rad]; by default 1e-9 for dop853, 1e-8 for rosenbrock"
    )
    rate_tolerance_rad_s: float = Field(
        default=1e-10, gt=0.0, description="error of a step in angular rate; rosenbrock also allows the angle's a step [rad/s]"
    )
    field_update: Literal["stage", "step"] = Field(
        default="stage",
        description='magnetic field at each stage of a step, or, with rk4, once per "step": faster, second order in the step',
    )
    line_update_s: float = Field(
        default=2.0, gt=0.0, le=60.0, description="how often field, air, plasma, light and current along lines are taken anew [s]"
    )

    @model_validator(mode="after")
    def _sees_its_error(self):
        """An adaptive step cannot see the error of a field that stands still in it, and would grow until it is wrong."""
        if self.method != "rk4" and self.field_update == "step":
            raise RecordError(
                [
                    (
                        "field_update",
                        'must be "stage" where the step is adaptive: its error control does not see what "step" leaves out',
                    )
                ]
            )
        return self

    @property
    def angle_allowed_rad(self) -> float:
        """Error of a step in attitude [rad]."""
        return self.angle_tolerance_rad or (1e-8 if self.method == "rosenbrock" else 1e-9)
