"""The same peg pushed into the same hole in the fake and in MuJoCo, which share no code.

MuJoCo's hole is a ring of 32 convex sectors with a chamfer, its peg a convex mesh on six springs
below a heavy carriage. Constant small impedance: with the usual one, stiffness would depend on how
deep a contact is. Quasi-static: impact would add at higher speeds.
"""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fakes.world.peg.fit import Fit
from tests.unit.fakes.world.peg.pushing import MM, above, arm, at_depth, lowered, pin, plug

mujoco = pytest.importorskip("mujoco")

_DT_S = 1e-4
_MASS_KG = 2.0
_INERTIA_KG_M2 = 2e-3
_CONTACT_N_M = 2e7
"""Stiffness of each of the few contacts that MuJoCo finds; every slot of the fake has it, too."""
_ABOVE_M = 0.2e-3
_SECTORS = 32
_OUTER_M = 25e-3
_LONG_M = 20e-3


@pytest.fixture(autouse=True)
def _no_log_in_the_repository(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """MuJoCo drops MUJOCO_LOG.TXT where it runs."""
    monkeypatch.chdir(tmp_path)


@dataclass(frozen=True)
class Push:
    """How a peg is held and pushed straight down."""

    fit: Fit
    lateral_n_m: float
    turning_nm_rad: float = 5e4
    off_m: float = 0.0
    tilt_rad: float = 0.0
    speed_m_s: float = 1.5e-3

    def in_the_fake(self, to_m: float) -> np.ndarray:
        """Rows of depth (m), F_x and F_z on the peg (N)."""
        held = arm(self.lateral_n_m, turning_nm_rad=self.turning_nm_rad)
        peg = above(self.fit, held, height_m=_ABOVE_M, x_m=self.off_m, tilt_rad=self.tilt_rad)
        rows = lowered(peg, -to_m, x_m=self.off_m, tilt_rad=self.tilt_rad)
        return rows[:, [0, 1, 3]]

    def in_mujoco(self, to_m: float) -> np.ndarray:
        """The same, from the springs that hold the peg, every two milliseconds as their mean."""
        model, data = self._model()
        # Joints in their order: carriage; x, y, z; about x, y, z.
        data.qpos[1], data.qpos[5] = self.off_m, self.tilt_rad
        rows, since = [], 0
        sums = np.zeros(3)
        for step in range(round((to_m + _ABOVE_M) / self.speed_m_s / _DT_S)):
            data.qpos[0], data.qvel[0] = _ABOVE_M - self.speed_m_s * step * _DT_S, -self.speed_m_s
            mujoco.mj_step(model, data)
            height_m = data.qpos[0] + data.qpos[3]
            side_n = self.lateral_n_m * (data.qpos[1] - self.off_m)
            sums += [-height_m, side_n, 1e6 * data.qpos[3]]
            since += 1
            if since == 20:
                rows.append(sums / since)
                sums, since = np.zeros(3), 0
        return np.array(rows)

    def _model(self) -> tuple[Any, Any]:
        springs = (
            ("slide", "1 0 0", self.lateral_n_m, _MASS_KG, self.off_m),
            ("slide", "0 1 0", self.lateral_n_m, _MASS_KG, 0.0),
            ("slide", "0 0 1", 1e6, _MASS_KG, 0.0),
            ("hinge", "1 0 0", self.turning_nm_rad, _INERTIA_KG_M2, 0.0),
            ("hinge", "0 1 0", self.turning_nm_rad, _INERTIA_KG_M2, self.tilt_rad),
            ("hinge", "0 0 1", self.turning_nm_rad, _INERTIA_KG_M2, 0.0),
        )
        joints = "".join(
            f'<joint type="{kind}" axis="{axis}" stiffness="{k:.9g}" springref="{rest:.9g}" '
            f'damping="{1.4 * np.sqrt(k * mass):.9g}"/>'
            for kind, axis, k, mass, rest in springs
        )
        parameter = _CONTACT_N_M / _MASS_KG
        meshes = {"peg": _peg(self.fit)} | {f"s{n}": _sector(self.fit, n) for n in range(_SECTORS)}
        assets = "".join(
            f'<mesh name="{name}" vertex="{" ".join(f"{v:.9g}" for v in points.ravel())}"/>'
            for name, points in meshes.items()
        )
        hole = "".join(f'<geom type="mesh" mesh="s{n}" {_HOLE}/>' for n in range(_SECTORS))
        model = mujoco.MjModel.from_xml_string(f"""
        <mujoco>
          <compiler angle="radian"/>
          <option timestep="{_DT_S}" gravity="0 0 0" integrator="implicitfast" cone="elliptic"
                  impratio="20"/>
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
                          diaginertia="{_INERTIA_KG_M2} {_INERTIA_KG_M2} {_INERTIA_KG_M2}"/>
                {joints}<geom type="mesh" mesh="peg" mass="0" {_PEG}/>
              </body>
            </body>
          </worldbody>
        </mujoco>""")
        return model, mujoco.MjData(model)


_HOLE = 'contype="2" conaffinity="4"'
_PEG = 'contype="4" conaffinity="2" pos="0 0 0"'


def _peg(fit: Fit) -> np.ndarray:
    angles = 2 * np.pi * np.arange(4 * _SECTORS) / (4 * _SECTORS)
    ring = np.column_stack([np.cos(angles), np.sin(angles)])
    rings = (
        (fit.rim_radius_m, 0.0),
        (fit.peg_radius_m, fit.peg_chamfer_m),
        (fit.peg_radius_m, _LONG_M),
    )
    return np.vstack([np.column_stack([r * ring, np.full(len(ring), z)]) for r, z in rings])


def _sector(fit: Fit, number: int) -> np.ndarray:
    """A wedge of the wall whose flat inner side stands at the bore's radius."""
    half = np.pi / _SECTORS
    outline = (
        (fit.mouth_radius_m, 0.0), (_OUTER_M, 0.0), (_OUTER_M, -_LONG_M),
        (fit.bore_radius_m, -_LONG_M), (fit.bore_radius_m, -fit.hole_chamfer_m),
    )  # fmt: skip
    # The middle of a flat side lies in the direction of x, in which the peg is off or tilted.
    return np.array(
        [
            [r / np.cos(half) * np.cos(angle), r / np.cos(half) * np.sin(angle), z]
            for angle in (half * (2 * number - 1), half * (2 * number + 1))
            for r, z in outline
        ]
    )


@pytest.mark.parametrize(
    "push",
    [
        Push(pin(0.05), 2e4, off_m=0.2 * MM),
        pytest.param(Push(pin(0.02), 2e4, off_m=0.5 * MM), marks=pytest.mark.long),
        Push(plug(), 5e4, off_m=0.4 * MM),
    ],
)
def test_one_point_contact(push: Push) -> None:
    fake, judge = push.in_the_fake(1.9 * MM), push.in_mujoco(1.9 * MM)
    inside = judge[judge[:, 0] > 1.5 * MM]
    assert fake[-1, 1] == pytest.approx(inside[:, 1].mean(), rel=0.1)
    assert fake[-1, 2] == pytest.approx(inside[:, 2].mean(), rel=0.1, abs=0.2)
    assert fake[:, 2].max() == pytest.approx(judge[:, 2].max(), rel=0.2)


@pytest.mark.long
@pytest.mark.parametrize(("clearance_mm", "tilt_deg"), [(0.02, 0.5), (0.05, 1.0)])
def test_two_point_contact(clearance_mm: float, tilt_deg: float) -> None:
    tilt = float(np.deg2rad(tilt_deg))
    push = Push(pin(clearance_mm), 2e4, 200.0, tilt_rad=tilt, speed_m_s=5e-3)
    fake, judge = push.in_the_fake(9.1 * MM), push.in_mujoco(9.1 * MM)
    for depth_mm in (8.0, 9.0):
        assert at_depth(fake, depth_mm)[1] == pytest.approx(at_depth(judge, depth_mm)[1], rel=0.25)
