"""One pin with a round tip in its funnel and bore: the closed form against MuJoCo.

MuJoCo's pin is a ball on a spring that a heavy carriage takes down along one wall: the flat of the
funnel, then the bore. Units are mm, N and t, because MuJoCo's tolerances suit lengths near one.
"""

from dataclasses import dataclass, replace
from math import atan, cos, degrees, sin
from pathlib import Path

import numpy as np
import pytest

from fakes.world.connector.contact_lot import MatingPair, MatingSizes, Mount
from fakes.world.connector.insertion import PlugPlace, outside, respond

mujoco = pytest.importorskip("mujoco")

RADIUS_MM = 0.25
SIZES = MatingSizes(wall_n_m=1e8)
"""The walls are as stiff as MuJoCo's: the spring of the mount gives way alone."""
LATERAL_N_MM = 20.0
FUNNEL_RAD = atan((SIZES.capture_m - SIZES.clear_m) / SIZES.funnel_m)
DT_S = 1e-4
SPEED_MM_S = 4.0
CLEAR_MM = SIZES.clear_m * 1e3
THICK_MM = 0.5


@pytest.fixture(autouse=True)
def _no_log_in_the_repository(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """MuJoCo drops MUJOCO_LOG.TXT where it runs."""
    monkeypatch.chdir(tmp_path)


@dataclass(frozen=True)
class Forces:
    """Forces on the pin: against the wall and along the axis."""

    side_n: float
    axial_n: float


def in_closed_form(offset_m: float, depth_m: float) -> Forces:
    zero = np.zeros((1, 2))
    pair = MatingPair(SIZES, zero, zero, np.zeros(1), np.ones(1), np.zeros(1))
    mount, place = Mount(lateral_n_m=LATERAL_N_MM * 1e3), PlugPlace(x_m=offset_m)
    entered = respond(pair, mount, outside(pair), replace(place, depth_m=1e-9)).states
    wrench = respond(pair, mount, entered, replace(place, depth_m=depth_m)).wrench
    return Forces(-float(wrench[0]), float(wrench[2]))


def in_mujoco(offset_mm: float, *, funnel: bool) -> Forces:
    """Mean forces while the ball slides along the flat of the funnel, or down the bore.

    One wall at a time: a ball that touches a single plane face behaves, meshes and edges do not.
    """
    # The wall's surface, for the middle of the ball, is its own plane moved by the radius.
    tilt = FUNNEL_RAD if funnel else 0.0
    normal = np.array([-cos(tilt), sin(tilt)])
    middle = np.array([CLEAR_MM, 0.0]) - (RADIUS_MM + THICK_MM) * normal
    damping = 2 * (LATERAL_N_MM * 1e-3) ** 0.5
    model = mujoco.MjModel.from_xml_string(f"""
    <mujoco>
      <compiler angle="degree"/>
      <option timestep="{DT_S}" gravity="0 0 0" integrator="implicitfast" cone="elliptic"
              impratio="100"/>
      <default><geom condim="3" friction="{SIZES.friction} 0 0" solimp="0.99 0.99 0.001"
                     solref="0.002 1"/></default>
      <worldbody>
        <geom type="box" size="{THICK_MM} 20 20" pos="{middle[0]:.9g} 0 {middle[1]:.9g}"
              euler="0 {degrees(tilt):.9g} 0"/>
        <body pos="0 0 0">
          <inertial pos="0 0 0" mass="1e-3" diaginertia="1 1 1"/>
          <joint type="slide" axis="0 0 1" armature="1e6"/>
          <body>
            <inertial pos="0 0 0" mass="1e-3" diaginertia="1 1 1"/>
            <joint type="slide" axis="1 0 0" stiffness="{LATERAL_N_MM}" damping="{damping}"
                   springref="{offset_mm}"/>
            <geom type="sphere" size="{RADIUS_MM}" mass="0"/>
          </body>
        </body>
      </worldbody>
    </mujoco>""")
    data = mujoco.MjData(model)
    begin_mm = 0.15 if funnel else 0.1
    forces = []
    for step in range(300):
        data.qpos[0], data.qvel[0] = begin_mm - SPEED_MM_S * step * DT_S, -SPEED_MM_S
        mujoco.mj_step(model, data)
        forces.append(force_on_ball(model, data))
    side, axial = np.mean(forces[200:], axis=0)
    return Forces(float(side), float(axial))


def force_on_ball(model, data) -> np.ndarray:  # type: ignore[no-untyped-def]
    total, local = np.zeros(3), np.zeros(6)
    for index in range(data.ncon):
        mujoco.mj_contactForce(model, data, index, local)
        frame = data.contact[index].frame.reshape(3, 3)
        total += frame.T @ local[:3]
    return np.array([abs(total[0]), abs(total[2])])


@pytest.mark.parametrize("offset_mm", [0.06, 0.10, 0.15, 0.19])
def test_bore(offset_mm: float) -> None:
    closed = in_closed_form(offset_mm * 1e-3, 0.4e-3)
    judge = in_mujoco(offset_mm, funnel=False)
    assert closed.side_n == pytest.approx(LATERAL_N_MM * (offset_mm - CLEAR_MM), rel=1e-3)
    assert judge.side_n == pytest.approx(closed.side_n, rel=0.05)
    assert judge.axial_n == pytest.approx(closed.axial_n, rel=0.05)


def test_flat_of_the_funnel() -> None:
    judge = in_mujoco(0.19, funnel=True)
    closed = in_closed_form(0.19e-3, 0.2e-3)
    assert closed.axial_n / closed.side_n == pytest.approx(1.017, abs=2e-3)
    assert judge.axial_n / judge.side_n == pytest.approx(1.017, rel=0.02)
