"""The same peg pushed into the same hole in the fake and in MuJoCo, which share no code.

MuJoCo's hole is a ring of convex sectors with flat inner sides; its peg, a cylinder or a convex
mesh with a chamfer, hangs on six springs below a heavy carriage. Constant small impedance: with the
usual one, stiffness would depend on how deep a contact is. Quasi-static: impact would add at higher
speeds. Its lengths are in mm and its forces in mN: the tolerance of its search is an absolute one.
"""

from dataclasses import dataclass
from typing import Any, Final

import numpy as np
import pytest

from fakes.world.frames import Array
from fakes.world.peg.attitude import axis_of
from fakes.world.peg.fit import Fit
from fakes.world.peg.held_peg import HeldPeg
from tests.unit.fakes.world.peg.pushing import arm

mujoco = pytest.importorskip("mujoco")

DEPTH, F_X, F_Y, F_Z, X, Y, COMMANDED = range(7)
"""Columns of what a push gives: depth of the tip (m), force on the peg (N), place of the tip (m),
and the height to which it is commanded (m)."""

_MM: Final = 1e3
_MASS_KG: Final = 2.0
_INERTIA_KG_M2: Final = 2e-3
_CONTACT_N_M: Final = 2e7
"""Stiffness of each of the few contacts that MuJoCo finds; every slot of the fake has it, too."""
_OUTER_M: Final = 25e-3
_LONG_M: Final = 20e-3
_FAR_M: Final = 0.5e-3
"""Sectors farther from the peg than this are left out."""
_MEAN_S: Final = 2e-3
_STEP_S: Final = 1e-3


@dataclass(frozen=True)
class Push:
    """How a peg is held and pushed straight down. Its tilt is about y."""

    fit: Fit
    lateral_n_m: float
    turning_nm_rad: float = 5e4
    axial_n_m: float = 1e6
    x_m: float = 0.0
    y_m: float = 0.0
    tilt_rad: float = 0.0
    speed_m_s: float = 1.5e-3
    sectors: int = 32
    dt_s: float = 1e-4
    """Step of MuJoCo; with long ones a contact at rest creeps."""

    def in_the_fake(self, from_m: float, to_m: float) -> Array:
        """Rows as named above, from one commanded height down to another."""
        held = arm(self.lateral_n_m, self.axial_n_m, self.turning_nm_rad)
        peg = HeldPeg(self.fit, held, (self.x_m, self.y_m, from_m, 0.0, self.tilt_rad, 0.0))
        rows = []
        for number in range(1, round((from_m - to_m) / (self.speed_m_s * _STEP_S)) + 1):
            height_m = from_m - self.speed_m_s * _STEP_S * number
            peg.follow((self.x_m, self.y_m, height_m, 0.0, self.tilt_rad, 0.0), _STEP_S)
            rows.append([-peg.pose[2], *peg.wrench[:3], *peg.pose[:2], height_m])
        return np.array(rows)

    def in_mujoco(self, from_m: float, to_m: float) -> Array:
        """The same, from the springs that hold the peg, every two milliseconds as their mean."""
        model, data = self._model(to_m)
        # Joints in their order: carriage; x, y, z; about x, y, z.
        data.qpos[[1, 2, 5]] = self.x_m * _MM, self.y_m * _MM, self.tilt_rad
        rows, together = [], round(_MEAN_S / self.dt_s)
        for step in range(round((from_m - to_m) / (self.speed_m_s * self.dt_s))):
            data.qvel[0] = -self.speed_m_s * _MM
            data.qpos[0] = from_m * _MM + data.qvel[0] * step * self.dt_s
            mujoco.mj_step(model, data)
            down, x, y, z = data.qpos[:4] / _MM
            springs_m = np.array([x - self.x_m, y - self.y_m, z])
            forces_n = springs_m * [self.lateral_n_m, self.lateral_n_m, self.axial_n_m]
            rows.append([-down - z, *forces_n, x, y, down])
        whole = len(rows) // together * together
        means = np.array(rows[:whole]).reshape(-1, together, len(rows[0])).mean(axis=1)
        return np.asarray(means)

    def _model(self, to_m: float) -> tuple[Any, Any]:
        turning, inertia = self.turning_nm_rad * _MM**2, _INERTIA_KG_M2 * _MM**2
        springs = (
            ("slide", "1 0 0", self.lateral_n_m, _MASS_KG, self.x_m * _MM),
            ("slide", "0 1 0", self.lateral_n_m, _MASS_KG, self.y_m * _MM),
            ("slide", "0 0 1", self.axial_n_m, _MASS_KG, 0.0),
            ("hinge", "1 0 0", turning, inertia, 0.0),
            ("hinge", "0 1 0", turning, inertia, self.tilt_rad),
            ("hinge", "0 0 1", turning, inertia, 0.0),
        )
        joints = "".join(
            f'<joint type="{kind}" axis="{axis}" stiffness="{k:.9g}" springref="{rest:.9g}" '
            f'damping="{1.4 * np.sqrt(k * mass):.9g}"/>'
            for kind, axis, k, mass, rest in springs
        )
        parameter = _CONTACT_N_M / _MASS_KG
        meshes = {f"s{n}": self._sector(n) for n in self._near(to_m)}
        hole = "".join(f'<geom type="mesh" mesh="{name}" {_HOLE}/>' for name in meshes)
        peg = _CYLINDER.format(self.fit.peg_radius_m * _MM, _LONG_M * _MM / 2)
        if self.fit.peg_chamfer_m > 0:
            meshes["peg"] = self._peg()
            peg = 'type="mesh" mesh="peg" pos="0 0 0"'
        assets = "".join(
            f'<mesh name="{name}" vertex="{" ".join(f"{v:.9g}" for v in points.ravel())}"/>'
            for name, points in meshes.items()
        )
        model = mujoco.MjModel.from_xml_string(f"""
        <mujoco>
          <compiler angle="radian"/>
          <option timestep="{self.dt_s}" gravity="0 0 0" integrator="implicitfast" cone="elliptic"
                  impratio="20" ccd_tolerance="1e-9" ccd_iterations="100"/>
          <asset>{assets}</asset>
          <default><geom condim="3" friction="{self.fit.friction} 0 0"
            solimp="0.001 0.001 0.001" solref="{-parameter} {-1.2 * np.sqrt(parameter)}"/></default>
          <worldbody>
            {hole}
            <body>
              <inertial pos="0 0 0" mass="1e-3" diaginertia="1e-6 1e-6 1e-6"/>
              <joint type="slide" axis="0 0 1" armature="1e9"/>
              <body>
                <inertial pos="0 0 0" mass="{_MASS_KG}"
                          diaginertia="{inertia} {inertia} {inertia}"/>
                {joints}<geom {peg} mass="0" {_PEG}/>
              </body>
            </body>
          </worldbody>
        </mujoco>""")
        return model, mujoco.MjData(model)

    def _near(self, to_m: float) -> list[int]:
        """Sectors whose wall begins near the way of the peg down."""
        axis = np.array(axis_of(0.0, self.tilt_rad))
        azimuth = 2 * np.pi * np.arange(self.sectors) / self.sectors
        edge = self.fit.bore_radius_m * np.array([np.cos(azimuth), np.sin(azimuth), 0 * azimuth])
        lever = edge.T - [self.x_m, self.y_m, to_m]
        along = lever @ axis
        from_axis = np.linalg.norm(lever - np.outer(along, axis), axis=1)
        near = (from_axis < self.fit.peg_radius_m + _FAR_M) & (along > -_FAR_M)
        return [int(n) for n in np.flatnonzero(near)]

    def _peg(self) -> Array:
        angles = 2 * np.pi * np.arange(4 * self.sectors) / (4 * self.sectors)
        ring = np.column_stack([np.cos(angles), np.sin(angles)])
        rings = (
            (self.fit.rim_radius_m, 0.0),
            (self.fit.peg_radius_m, self.fit.peg_chamfer_m),
            (self.fit.peg_radius_m, _LONG_M),
        )
        return _MM * np.vstack(
            [np.column_stack([r * ring, np.full(len(ring), z)]) for r, z in rings]
        )

    def _sector(self, number: int) -> Array:
        """A wedge of the wall whose flat inner side stands at the bore's radius."""
        half, fit = np.pi / self.sectors, self.fit
        outline = (
            (fit.mouth_radius_m, 0.0), (_OUTER_M, 0.0), (_OUTER_M, -_LONG_M),
            (fit.bore_radius_m, -_LONG_M), (fit.bore_radius_m, -fit.hole_chamfer_m),
        )  # fmt: skip
        # The middle of a flat side lies in the direction of x.
        return _MM * np.array(
            [
                [r / np.cos(half) * np.cos(angle), r / np.cos(half) * np.sin(angle), z]
                for angle in (half * (2 * number - 1), half * (2 * number + 1))
                for r, z in outline
            ]
        )


_HOLE: Final = 'contype="2" conaffinity="4"'
_PEG: Final = 'contype="4" conaffinity="2"'
_CYLINDER: Final = 'type="cylinder" size="{0:.9g} {1:.9g}" pos="0 0 {1:.9g}"'
