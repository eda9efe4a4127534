"""The same payload over the same frame in the fake and in MuJoCo, which share no code.

Recipe: constant small impedance (``solimp`` 0.001), direct ``solref``, ``implicitfast``, 0.1 ms.
With MuJoCo's usual impedance the impact stiffness is far below the static one.
"""

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform, Rotation

from fakes.faults import FaultBoard
from fakes.scenes.deck_on_frame.parts import draw_parts
from fakes.scenes.deck_on_frame.scenario import DeckScenario
from fakes.scenes.deck_on_frame.scene import FAULTS, deck_payload
from fakes.world.load.payload import STEP_S, Payload
from fakes.world.truth import draw

mujoco = pytest.importorskip("mujoco")

SCENARIO = Path(__file__).parents[4] / "config" / "deck.scenario.toml"
MASS_KG = 200.0
DT_S = 1e-4
GAP_M = 5e-5
RADIUS_M = 0.005
SLOPE_M_S2 = 0.5
"""Deceleration of the stop."""


@dataclass(frozen=True)
class Travel:
    """The flange goes down at a speed, and brakes to stand ``depth_m`` below first contact."""

    speed_m_s: float
    depth_m: float

    @property
    def brake_s(self) -> float:
        ramp_m = self.speed_m_s**2 / (2.0 * SLOPE_M_S2)
        return (GAP_M + self.depth_m - ramp_m) / self.speed_m_s

    @property
    def end_s(self) -> float:
        return self.brake_s + self.speed_m_s / SLOPE_M_S2

    def speed_at(self, time_s: float) -> float:
        return float(np.clip(self.speed_m_s - SLOPE_M_S2 * (time_s - self.brake_s), 0.0,
                             self.speed_m_s))  # fmt: skip

    def way_at(self, time_s: float) -> float:
        braking_s = float(np.clip(time_s - self.brake_s, 0.0, self.end_s - self.brake_s))
        straight_s = min(time_s, self.brake_s)
        return self.speed_m_s * (straight_s + braking_s) - 0.5 * SLOPE_M_S2 * braking_s**2


@dataclass(frozen=True)
class Rig:
    """The same payload for both: pads around the centre of mass, springs, contact."""

    scenario: DeckScenario
    contact_n_m: float
    tilt: Rotation

    @property
    def com_T_deck(self) -> RigidTransform:
        payload = self.payload()
        assert payload.touch is not None
        return payload.flange_T_com.inv() * payload.touch.flange_T_body

    @property
    def pads_in_com_m(self) -> np.ndarray:
        touch = self.payload().touch
        assert touch is not None
        pads = self.scenario.contact.pads
        return np.asarray(self.com_T_deck.apply(touch.points.points_m[:pads]))

    def payload(self) -> Payload:
        scenario = self.scenario
        parts = replace(
            draw_parts(scenario, 1, 1),
            cell_T_frame=RigidTransform.identity(),
            flange_T_deck=RigidTransform.from_components(
                [0.0, 0.0, 0.502], Rotation.from_euler("x", 180, degrees=True) * self.tilt
            ),
            deck_thickness_m=0.015,
            contact_stiffness_n_m=self.contact_n_m,
        )
        sensor = draw(scenario, 1).force_sensors["force"]
        faults = FaultBoard("world", FAULTS)
        return deck_payload(scenario, sensor, parts, faults, frame_present=True)

    def fake_force(self, travel: Travel, seconds: float) -> np.ndarray:
        """Contact force of the fake, every millisecond."""
        payload = self.payload()
        assert payload.touch is not None
        start = np.eye(4)
        start[:3, :3] = np.diag([1.0, -1.0, -1.0])
        start_T_deck = start @ payload.touch.flange_T_body.as_matrix()
        lowest_m = float(payload.touch.points.gaps(start_T_deck).min())
        start[2, 3] = GAP_M - lowest_m
        payload.advance(start, moving=False)
        forces = []
        for tick in range(1, round(seconds / STEP_S) + 1):
            flange = start.copy()
            flange[2, 3] -= travel.way_at(tick * STEP_S)
            payload.advance(flange, moving=True)
            forces.append(payload.contact_force_n)
        return np.array(forces)


def rig(contact_n_m: float, tilt_deg: tuple[float, float] = (0.0, 0.0)) -> Rig:
    scenario = DeckScenario.read(SCENARIO).without_imperfections()
    smooth = scenario.contact.model_copy(update={"friction": 0.0})
    tilt = Rotation.from_rotvec(np.deg2rad([*tilt_deg, 0.0]))
    return Rig(scenario.model_copy(update={"contact": smooth}), contact_n_m, tilt)


class Oracle:
    """The rig in MuJoCo: a heavy carriage that follows the travel, springs, pads, a plane."""

    assets = on_the_frame = on_the_deck = ""
    """More of the model, in its own language."""

    def __init__(self, rig: Rig) -> None:
        self.rig = rig
        guess = rig.contact_n_m / MASS_KG
        self.parameter = guess * rig.contact_n_m / self._press(guess)
        self.pressed_n_m = self._press(self.parameter)

    def force(self, travel: Travel, seconds: float) -> np.ndarray:
        """Contact force, every millisecond."""
        model, data = self.build(self.parameter, GAP_M)
        forces = []
        each = round(STEP_S / DT_S)
        for step in range(round(seconds / DT_S)):
            carry(data, -travel.way_at(step * DT_S), -travel.speed_at(step * DT_S))
            mujoco.mj_step(model, data)
            if step % each == each - 1:
                forces.append(self.normal_force(model, data))
        return np.array(forces)

    def _press(self, parameter: float) -> float:
        """Static stiffness of all pads together: their forces by their mean depth."""
        model, data = self.build(parameter, 0.0)
        calm = np.array([0.0, *[2e4] * 3, *[5e3] * 3])
        for _ in range(20_000):
            data.qpos[0] = data.qvel[0] = 0.0
            data.qfrc_applied[:] = -calm * data.qvel
            data.qfrc_applied[3] -= 400.0
            mujoco.mj_step(model, data)
        assert data.ncon == len(self.rig.pads_in_com_m), "every pad carries"
        return -self.normal_force(model, data) / float(np.mean(data.contact.dist))

    def build(self, parameter: float, gap_m: float):  # type: ignore[no-untyped-def]
        payload = self.rig.scenario.payload
        mass = np.array([MASS_KG] * 3 + list(payload.inertia_kg_m2))
        spring = np.array([*payload.stiffness_n_m, *payload.rotational_stiffness_nm_rad])
        damping = 2.0 * payload.damping_ratio * np.sqrt(spring * mass)
        pads = self.rig.pads_in_com_m
        height_m = RADIUS_M - pads[:, 2].min() + gap_m
        zeta = self.rig.scenario.contact.damping_ratio
        rub = 2.0 * zeta * parameter * np.sqrt(MASS_KG / self.rig.contact_n_m)
        joints = "".join(
            f'<joint type="{kind}" axis="{axis}" stiffness="{k:.9g}" damping="{c:.9g}"/>'
            for (kind, axis), k, c in zip(_AXES, spring, damping, strict=True)
        )
        spheres = "".join(
            f'<geom type="sphere" size="{RADIUS_M}" pos="{x:.9g} {y:.9g} {z:.9g}" mass="0"/>'
            for x, y, z in pads
        )
        inertia = " ".join(f"{value:.9g}" for value in payload.inertia_kg_m2)
        model = mujoco.MjModel.from_xml_string(f"""
        <mujoco>
          <option timestep="{DT_S}" gravity="0 0 0" integrator="implicitfast"/>
          <asset>{self.assets}</asset>
          <default><geom condim="1" solimp="0.001 0.001 0.001" solref="{-parameter} {-rub}"/>
          </default>
          <worldbody>
            <geom type="plane" size="5 5 1"/>
            {self.on_the_frame}
            <body pos="0 0 {height_m:.9g}">
              <inertial pos="0 0 0" mass="1e-3" diaginertia="1e-6 1e-6 1e-6"/>
              <joint type="slide" axis="0 0 1" armature="1e9"/>
              <body>
                <inertial pos="0 0 0" mass="{MASS_KG}" diaginertia="{inertia}"/>
                {joints}{spheres}{self.on_the_deck}
              </body>
            </body>
          </worldbody>
        </mujoco>""")
        return model, mujoco.MjData(model)

    @staticmethod
    def normal_force(model, data) -> float:  # type: ignore[no-untyped-def]
        total, force = 0.0, np.zeros(6)
        for index in range(data.ncon):
            mujoco.mj_contactForce(model, data, index, force)
            total += force[0]
        return total


def carry(data, place_m: float, speed_m_s: float) -> None:  # type: ignore[no-untyped-def]
    """Prescribe the carriage and leave the payload its own speed.

    Joints hold relative speeds: without the second line the payload would start and brake with the
    carriage as if it had no inertia.
    """
    data.qvel[_HANGING_Z] -= speed_m_s - data.qvel[0]
    data.qpos[0], data.qvel[0] = place_m, speed_m_s


_HANGING_Z = 3
_AXES = (
    ("slide", "1 0 0"),
    ("slide", "0 1 0"),
    ("slide", "0 0 1"),
    ("hinge", "1 0 0"),
    ("hinge", "0 1 0"),
    ("hinge", "0 0 1"),
)
