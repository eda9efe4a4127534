"""What hangs from a robot's flange behind a force sensor: motion, contact, the load on the sensor.

Tool axes are flange axes turned by 180° about x: z up while a part is held over its place.
Gravity is left out of the deflection, as a controller that knows its load corrects the sag; the
sensor feels it all the same.
"""

import math
from dataclasses import replace

import numpy as np
from scipy.spatial.transform import RigidTransform, Rotation

from fakes.scenario_file.sections import Springs
from fakes.world.frames import Array, displacement
from fakes.world.load.contact import OUT_OF_REACH_M, Touch
from fakes.world.load.suspension import Contacts, Suspension

STEP_S = 1e-3
_SUBSTEPS = 2
_NEAR_M = 2e-3
"""Farther away than this a body swings freely, which takes no search for its contacts."""
_SETTLED = 1e-12
"""Change of place (m, rad) and rate (m/s, rad/s) in a millisecond below which a suspension stands:
a newton out of balance changes the rate of 50 kg by 2e-5 m/s in that time."""
_GRAVITY = np.array([0.0, 0.0, -9.80665])
"""Standard gravity, m/s², in the frame of the cell."""
_SLIP_M_S = 1e-4
"""Friction is viscous below this speed."""
_FLANGE_R_TOOL = Rotation.from_euler("x", 180, degrees=True)
_TOOL_R_FLANGE = _FLANGE_R_TOOL.inv().as_matrix()


class Payload:
    """Advanced once a millisecond with the true pose of the flange."""

    def __init__(
        self,
        springs: Springs,
        flange_T_sensor: RigidTransform,
        *,
        mass_kg: float,
        com_in_flange_m: Array,
        touch: Touch | None = None,
    ) -> None:
        """``flange_T_sensor`` is the true pose of the sensor; ``touch`` is None where there is
        nothing to touch."""
        self.flange_T_com = RigidTransform.from_components(com_in_flange_m, _FLANGE_R_TOOL)
        self._com = np.append(com_in_flange_m, 1.0)
        self._weight = mass_kg * _GRAVITY
        self._weight_in_tool = self._weight
        self._sensor_A_com = _adjoint(flange_T_sensor.inv() * self.flange_T_com)
        self.touch = touch
        contacts = Contacts.none()
        if touch is not None:
            self._body_matrix = touch.flange_T_body.as_matrix()
            self._other_T_cell = touch.cell_T_other.inv().as_matrix()
            com_T_body = self.flange_T_com.inv() * touch.flange_T_body
            contacts = touch.points.contacts(com_T_body, touch.damping_ratio, mass_kg)
        self.suspension = Suspension(springs, mass_kg, contacts)
        self._normals = normals = np.ascontiguousarray(contacts.jacobian[:, :3])
        self._guides_carries = np.column_stack(
            [np.hypot(normals[:, 0], normals[:, 1]), normals[:, 2]]
        )
        self._pose: Array | None = None
        self._speeds = np.zeros((3, 2))  # of the centre of mass, and of turning, in cell axes
        self._gaps = np.full(len(contacts.stiffness_n_m), OUT_OF_REACH_M)
        self._settled = False
        self.contact_force_n = 0.0
        self.peak_contact_force_n = 0.0
        self.load = np.zeros(6)

    def regrip(self, flange_T_body: RigidTransform) -> bool:
        """The body hangs a few micrometres elsewhere from now on: too little for the levers.

        False, and nothing has changed, where it would be pressed into something there: a wall
        beside it holds it back, and a body that is put into a stiff wall would be given an energy
        that no slip has.
        """
        if self.touch is None:
            return True
        body = flange_T_body.as_matrix()
        if self._pose is not None:
            gaps = self.touch.points.gaps(self._other_T_cell @ self._pose @ body)
            if self.suspension.closes(gaps):
                return False
            self._gaps = gaps
        self._settled = False
        self.touch = replace(self.touch, flange_T_body=flange_T_body)
        self._body_matrix = body
        return True

    def advance(self, flange: Array, *, moving: bool) -> None:
        """One millisecond on; ``flange`` is the true cell_T_flange at its end, 4x4."""
        if self._pose is None:
            self._pose = flange
            self._gaps = self._gaps_at(flange)
            self._weight_in_tool = _TOOL_R_FLANGE @ flange[:3, :3].T @ self._weight
            self.load = self._sensed()
        standing = not moving and flange is self._pose
        at_rest = standing and not self._speeds.any()
        if at_rest and self._settled:
            self.peak_contact_force_n = max(self.peak_contact_force_n, self.contact_force_n)
            return
        state = self.suspension.state
        gaps = self._gaps if standing else self._gaps_at(flange)
        rates = (gaps - self._gaps) / STEP_S
        if at_rest:
            inertia, slide = np.zeros(6), np.zeros(3)
        else:
            self._weight_in_tool = (tool_R_cell := _TOOL_R_FLANGE @ flange[:3, :3].T) @ self._weight
            inertia, slide = self._inertia(flange, tool_R_cell)
        if self._near(gaps):
            self._push(rates, inertia, slide)
        else:
            self.suspension.free(STEP_S, inertia)
            self.contact_force_n = 0.0
        self._pose, self._gaps = flange, gaps
        self._settled = at_rest and bool(np.abs(self.suspension.state - state).max() < _SETTLED)
        self.load = self._sensed()

    def deflected(self, flange_T_body: RigidTransform) -> RigidTransform:
        """Where the present deflection carries a body that hangs from the flange."""
        bend = self.suspension.deflection
        com = self.flange_T_com
        moved: RigidTransform = com * displacement(bend[:3], bend[3:]) * com.inv()
        return moved * flange_T_body

    def _push(self, rates: Array, inertia: Array, slide: Array) -> None:
        suspension, step_s = self.suspension, STEP_S / _SUBSTEPS
        wrench = inertia.copy()
        for index in range(_SUBSTEPS):
            drag = self._drag(slide + suspension.rate[:3])
            wrench[:3] = inertia[:3] + drag
            gaps = self._gaps + index * step_s * rates
            suspension.touch(step_s, gaps, rates, wrench, goes_on=index > 0)
            force = suspension.normal_forces @ self._normals + drag
            self.contact_force_n = math.sqrt(force @ force)
            self.peak_contact_force_n = max(self.peak_contact_force_n, self.contact_force_n)

    def _drag(self, speed: Array) -> Array:
        """Friction: across the approach of what carries, along it of what guides (pins)."""
        guiding, carrying = self.suspension.normal_forces @ self._guides_carries
        x, y, z = speed.tolist()
        friction = self.touch.friction if self.touch is not None else 0.0
        across = -friction * carrying / (math.hypot(x, y) + _SLIP_M_S)
        along = -friction * guiding / (abs(z) + _SLIP_M_S)
        return np.array([across * x, across * y, along * z])

    def _near(self, gaps: Array) -> bool:
        if self.touch is None:
            return False
        distance = self.touch.points.distance
        return distance(gaps) < _NEAR_M or (
            gaps is not self._gaps and distance(self._gaps) < _NEAR_M
        )

    def _gaps_at(self, flange: Array) -> Array:
        if self.touch is None:
            return self._gaps
        return self.touch.points.gaps(self._other_T_cell @ flange @ self._body_matrix)

    def _inertia(self, flange: Array, tool_R_cell: Array) -> tuple[Array, Array]:
        """Force and torque of inertia in tool axes, and the sliding speed there."""
        before = self._pose
        assert before is not None
        _, xy, xz, yx, _, yz, zx, zy, _ = (flange[:3, :3] @ before[:3, :3].T).ravel().tolist()
        speeds = np.empty((3, 2))
        speeds[:, 0] = (flange - before)[:3] @ self._com
        speeds[:, 1] = (0.5 * (zy - yz), 0.5 * (xz - zx), 0.5 * (yx - xy))
        speeds /= STEP_S
        wrench = (tool_R_cell @ (self._speeds - speeds)).T.ravel()
        wrench *= self.suspension.mass
        wrench /= STEP_S
        self._speeds = speeds
        return wrench, tool_R_cell @ speeds[:, 0]

    def _sensed(self) -> Array:
        """True load in sensor axes: springs and gravity."""
        wrench = self.suspension.spring_wrench
        wrench[:3] += self._weight_in_tool
        return np.asarray(self._sensor_A_com @ wrench)


def _adjoint(b_T_a: RigidTransform) -> Array:
    """Matrix that carries a wrench about the origin of a, in its axes, to b."""
    rotation, (x, y, z) = b_T_a.rotation.as_matrix(), b_T_a.translation
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    result = np.zeros((6, 6))
    result[:3, :3] = result[3:, 3:] = rotation
    result[3:, :3] = cross @ rotation
    return result
