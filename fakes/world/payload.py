"""What hangs from the main robot's flange: motion, contact and the load on the force sensor.

Tool axes are flange axes turned by 180° about x: z up while the deck is held over the frame.
Gravity is left out of the deflection, as a controller that knows its load corrects the sag; the
sensor feels it all the same.
"""

import math

import numpy as np
from scipy.spatial.transform import RigidTransform, Rotation

from fakes.faults import FaultBoard
from fakes.scenario import Scenario
from fakes.world.contact import OUT_OF_REACH_M, Rim, rim
from fakes.world.frames import MM, Array, displacement, from_written
from fakes.world.suspension import Contacts, Suspension
from fakes.world.truth import PartsTruth, SensorTruth

STEP_S = 1e-3
_SUBSTEPS = 4
_NEAR_M = 2e-3
_GRAVITY = np.array([0.0, 0.0, -9.80665])
_SLIP_M_S = 1e-4
"""Friction is viscous below this speed."""
_FLANGE_R_TOOL = Rotation.from_euler("x", 180, degrees=True)
_TOOL_R_FLANGE = _FLANGE_R_TOOL.inv().as_matrix()


class Payload:
    """Advanced once a millisecond with the true pose of the flange."""

    def __init__(
        self,
        scenario: Scenario,
        sensor: SensorTruth,
        parts: PartsTruth | None,
        faults: FaultBoard,
        *,
        frame_present: bool,
    ) -> None:
        settings = scenario.payload
        self._friction = scenario.contact.friction
        mass = settings.gripper_kg + (settings.deck_kg if parts else 0.0)
        com_mm = settings.com_in_sensor_mm if parts else settings.gripper_com_in_sensor_mm
        flange_T_sensor = from_written(scenario.force_sensor.flange_T_sensor_mm_deg)
        com = flange_T_sensor.apply(np.array(com_mm) * MM)
        self._flange_T_com = RigidTransform.from_components(com, _FLANGE_R_TOOL)
        self._com = np.append(com, 1.0)
        self._weight = mass * _GRAVITY
        self._sensor_A_com = _adjoint(sensor.flange_T_sensor.inv() * self._flange_T_com)
        self._rim: Rim | None = None
        contacts = Contacts.none()
        if parts is not None:
            self._flange_T_deck = parts.flange_T_deck
            self._deck_matrix = parts.flange_T_deck.as_matrix()
            if frame_present and not faults.active("no_frame"):
                self._frame_T_cell = parts.cell_T_frame.inv().as_matrix()
                self._rim = rim(scenario, parts, faults)
                com_T_deck = self._flange_T_com.inv() * parts.flange_T_deck
                contacts = self._rim.contacts(com_T_deck, scenario.contact.damping_ratio, mass)
        self.suspension = Suspension(settings, mass, contacts)
        normals = contacts.jacobian[:, :3]
        self._guides_carries = np.column_stack(
            [np.hypot(normals[:, 0], normals[:, 1]), normals[:, 2]]
        )
        self._pose: Array | None = None
        self._com_speed = np.zeros(3)
        self._turn_speed = np.zeros(3)
        self._gaps = np.full(len(contacts.stiffness_n_m), OUT_OF_REACH_M)
        self.contact_force_n = 0.0
        self.peak_contact_force_n = 0.0
        self.load = np.zeros(6)

    def advance(self, flange: Array, *, moving: bool) -> None:
        """One millisecond on; ``flange`` is the true cell_T_flange at its end, 4x4."""
        if self._pose is None:
            self._pose = flange
            self._gaps = self._gaps_at(flange)
            self.load = self._sensed(flange)
        standing = not moving and flange is self._pose
        if standing and self.suspension.resting and not self._com_speed.any():
            self.contact_force_n = 0.0
            return
        gaps = self._gaps if standing else self._gaps_at(flange)
        rates = (gaps - self._gaps) / STEP_S
        tool_R_cell = _TOOL_R_FLANGE @ flange[:3, :3].T
        inertia, slide = self._inertia(flange, tool_R_cell)
        if self._near(gaps):
            self._touch(rates, inertia, slide)
        else:
            self.suspension.free(STEP_S, inertia)
            self.contact_force_n = 0.0
        self._pose, self._gaps = flange, gaps
        self.load = self._sensed(flange)

    def deck_in_flange(self) -> RigidTransform:
        """flange_T_deck under the present deflection."""
        bend = self.suspension.deflection
        com = self._flange_T_com
        moved: RigidTransform = com * displacement(bend[:3], bend[3:]) * com.inv()
        return moved * self._flange_T_deck

    def _touch(self, rates: Array, inertia: Array, slide: Array) -> None:
        suspension, step_s = self.suspension, STEP_S / _SUBSTEPS
        for index in range(_SUBSTEPS):
            drag = self._drag(slide + suspension.rate[:3])
            wrench = inertia.copy()
            wrench[:3] += drag
            suspension.touch(step_s, self._gaps + index * step_s * rates, rates, wrench)
            force = suspension.normal_forces @ suspension.contacts.jacobian[:, :3]
            self.contact_force_n = float(np.linalg.norm(force + drag))
            self.peak_contact_force_n = max(self.peak_contact_force_n, self.contact_force_n)

    def _drag(self, speed: Array) -> Array:
        """Friction: across the approach of what carries, along it of what guides (pins)."""
        guiding, carrying = self.suspension.normal_forces @ self._guides_carries
        x, y, z = speed.tolist()
        across = -self._friction * carrying / (math.hypot(x, y) + _SLIP_M_S)
        along = -self._friction * guiding / (abs(z) + _SLIP_M_S)
        return np.array([across * x, across * y, along * z])

    def _near(self, gaps: Array) -> bool:
        rim = self._rim
        return rim is not None and min(rim.distance(self._gaps), rim.distance(gaps)) < _NEAR_M

    def _gaps_at(self, flange: Array) -> Array:
        if self._rim is None:
            return self._gaps
        return self._rim.gaps(self._frame_T_cell @ flange @ self._deck_matrix)

    def _inertia(self, flange: Array, tool_R_cell: Array) -> tuple[Array, Array]:
        """Force and torque of inertia in tool axes, and the sliding speed there."""
        before = self._pose
        assert before is not None
        speed = (flange @ self._com - before @ self._com)[:3] / STEP_S
        turn = flange[:3, :3] @ before[:3, :3].T
        turn_speed = 0.5 * np.array(
            [turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]]
        )
        turn_speed /= STEP_S
        mass = self.suspension.mass
        force = -mass[:3] * (tool_R_cell @ (speed - self._com_speed)) / STEP_S
        torque = -mass[3:] * (tool_R_cell @ (turn_speed - self._turn_speed)) / STEP_S
        self._com_speed, self._turn_speed = speed, turn_speed
        return np.concatenate([force, torque]), tool_R_cell @ speed

    def _sensed(self, flange: Array) -> Array:
        """True load in sensor axes: springs and gravity."""
        wrench = self.suspension.spring_wrench
        wrench[:3] += _TOOL_R_FLANGE @ flange[:3, :3].T @ self._weight
        return np.asarray(self._sensor_A_com @ wrench)


def _adjoint(b_T_a: RigidTransform) -> Array:
    """Matrix that carries a wrench about the origin of a, in its axes, to b."""
    rotation, (x, y, z) = b_T_a.rotation.as_matrix(), b_T_a.translation
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    result = np.zeros((6, 6))
    result[:3, :3] = result[3:, 3:] = rotation
    result[3:, :3] = cross @ rotation
    return result
