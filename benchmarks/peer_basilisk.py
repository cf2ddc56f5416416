"""The benchmark's satellite in Basilisk (`bsk` of PyPI): J2, WMM2025, RK4 at 1 s, torquers, B-dot or no law.

Basilisk evaluates its field once a step, and a law there is a module of Python or C++; here it is of Python, as a user
writes one. The two runs are the same satellite, not the same arithmetic: what is compared is steps a second.
"""

from __future__ import annotations

import tempfile
from importlib import resources
from pathlib import Path

import numpy as np

J2 = 1.0826359e-3
GM_M3_S2 = 3.986004418e14
RADIUS_M = 6378136.3
MOMENT_MAX_A_M2 = 0.2
GAIN_N_M_S = 9e-5
SECOND_NS = 1_000_000_000


def b_dot_module(magnetometer, commands):
    """A module that turns the field's change into a dipole, once a second."""
    from Basilisk.architecture import messaging, sysModel
    from Basilisk.utilities import RigidBodyKinematics

    class BDot(sysModel.SysModel):
        """M = clip(-k / B^2 dB/dt)."""

        def __init__(self, state):
            super().__init__()
            self.ModelTag = "b-dot"
            self.field, self.state = magnetometer.addSubscriber(), state.addSubscriber()
            self.before = None

        def UpdateState(self, nanoseconds):  # noqa: N802  Basilisk calls it by this name
            """One call of the law."""
            dcm_bn = RigidBodyKinematics.MRP2C(self.state().sigma_BN)
            field_b = dcm_bn @ np.array(self.field().magField_N)
            moment = np.zeros(3)
            if self.before is not None:
                moment = -GAIN_N_M_S / (field_b @ field_b) * (field_b - self.before)
            self.before = field_b
            payload = messaging.MTBCmdMsgPayload()
            payload.mtbDipoleCmds = list(np.clip(moment, -MOMENT_MAX_A_M2, MOMENT_MAX_A_M2)) + [0.0] * 33
            commands.write(payload, nanoseconds, self.moduleID)

    return BDot


def satellite():
    """A spacecraft with point gravity and J2."""
    from Basilisk.simulation import gravityEffector, spacecraft

    craft = spacecraft.Spacecraft()
    craft.ModelTag = "satellite"
    craft.hub.mHub = 4.0
    craft.hub.IHubPntBc_B = [[0.02, 0.0, 0.0], [0.0, 0.03, 0.0], [0.0, 0.0, 0.035]]
    craft.hub.r_CN_NInit = [[6.878e6], [0.0], [0.0]]
    craft.hub.v_CN_NInit = [[0.0], [1000.0], [7540.0]]
    craft.hub.sigma_BNInit = [[0.0], [0.0], [0.0]]
    craft.hub.omega_BN_BInit = [[float(np.radians(rate))] for rate in (3.0, 2.0, 1.0)]
    earth = gravityEffector.GravBodyData()
    earth.planetName, earth.isCentralBody, earth.mu, earth.radEquator = "earth_planet_data", True, GM_M3_S2, RADIUS_M
    model = gravityEffector.SphericalHarmonicsGravityModel()
    model.muBody, model.radEquator, model.maxDeg = GM_M3_S2, RADIUS_M, 2
    model.cBar = [[1.0], [0.0, 0.0], [-J2 / np.sqrt(5.0), 0.0, 0.0]]
    model.sBar = [[0.0], [0.0, 0.0], [0.0, 0.0, 0.0]]
    earth.gravityModel = model
    craft.gravField.gravBodies = gravityEffector.GravBodyVector([earth])
    return craft, (earth, model)


def simulation(law: bool, folder: Path):
    """A run that is set up: `advance(steps)` flies on, and what must stay alive."""
    from Basilisk.architecture import messaging
    from Basilisk.simulation import MtbEffector, magneticFieldWMM
    from Basilisk.utilities import SimulationBaseClass, macros

    base = SimulationBaseClass.SimBaseClass()
    base.CreateNewProcess("process").addTask(base.CreateNewTask("task", macros.sec2nano(1.0)))
    craft, kept = satellite()
    field = magneticFieldWMM.MagneticFieldWMM()
    field.ModelTag = "WMM"
    field.configureWMMFile(str(folder / "WMM.COF"))
    field.addSpacecraftToModel(craft.scStateOutMsg)
    field.epochDateFractionalYear = 2026.16
    torquers = MtbEffector.MtbEffector()
    config = messaging.MTBArrayConfigMsgPayload()
    config.numMTB, config.maxMtbDipoles = 3, [MOMENT_MAX_A_M2] * 3
    config.GtMatrix_B = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]
    axes, commands = messaging.MTBArrayConfigMsg().write(config), messaging.MTBCmdMsg()
    commands.write(messaging.MTBCmdMsgPayload())
    torquers.mtbParamsInMsg.subscribeTo(axes)
    torquers.mtbCmdInMsg.subscribeTo(commands)
    torquers.magInMsg.subscribeTo(field.envOutMsgs[0])
    craft.addDynamicEffector(torquers)
    modules = [craft, torquers, field]
    if law:
        modules.append(b_dot_module(field.envOutMsgs[0], commands)(craft.scStateOutMsg))
    for module in modules:
        base.AddModelToTask("task", module)
    base.InitializeSimulation()
    done = 0

    def advance(steps: int) -> None:
        nonlocal done
        done += steps
        base.ConfigureStopTime(done * SECOND_NS)
        base.ExecuteSimulation()

    return advance, (base, modules, kept, axes, commands)


def flights() -> dict:
    """{"without a law", "with a law in Python": advance(steps)}; ImportError where Basilisk is not installed."""
    import Basilisk

    made = {}
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        write_wmm(folder / "WMM.COF")
        for words, law in (("without a law", False), ("with a law in Python", True)):
            advance, alive = simulation(law, folder)
            advance.alive = (alive, Basilisk)
            made[words] = advance
    return made


def write_wmm(path: Path) -> None:
    """The coefficients that come with Fieldline, in the file that Basilisk reads."""
    text = (resources.files("fieldline") / "data" / "wmm2025.cof").read_text(encoding="utf-8")
    path.write_text(text, encoding="utf-8")
