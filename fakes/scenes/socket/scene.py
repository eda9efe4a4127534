"""A peg in the fingers of one arm finds its hole by touch.

What the arm holds is quasi-static: the contact acts through the compliance of arm and wrist, the
inertia is that of the tool alone and does not bounce on the contact.
"""

import math
from collections.abc import Iterable, Mapping
from typing import Any, ClassVar

import numpy as np
from scipy.spatial.transform import RigidTransform

from fakes.scenario_file.scenario import Scenario
from fakes.scenes.socket.part import FAULTS, draw_part, fit_with, grip_force_n, nominal_fit
from fakes.scenes.socket.peaks import ForcePeaks
from fakes.scenes.socket.scenario import SocketScenario
from fakes.world.frames import MM, Array, from_written, inverse_matrix, to_written
from fakes.world.load.mounted_sensor import STEP_S
from fakes.world.load.payload import Payload
from fakes.world.peg.attitude import pose_of
from fakes.world.peg.held_peg import HeldPeg
from fakes.world.scene import Seen
from fakes.world.world import Command, World

_SEAT_MM = 0.3
"""A peg that is nearer to its seat than this is in: the tolerance of the depth that proves a seat
(section 5.4 of the study of insertion by touch)."""
_HOLE_FAULTS = ("hole_absent", "wrong_hole", "wrong_size", "blocked")


class SocketScene(World[SocketScenario]):
    """One arm with a force sensor, a gripped peg, and a face with a hole."""

    scenario_model: ClassVar[type[Scenario]] = SocketScenario
    fault_texts: ClassVar[Mapping[str, str]] = FAULTS

    def __init__(self, scenario: SocketScenario, seed: int) -> None:
        super().__init__(scenario, seed)
        settings = scenario.peg
        self._flange_T_sensor = self.truth.force_sensors[settings.force_sensor].flange_T_sensor
        sensor = scenario.force_sensors[settings.force_sensor]
        nominal = from_written(sensor.flange_T_sensor_mm_deg)
        self._tool = Payload(
            settings,
            self._flange_T_sensor,
            mass_kg=settings.mass_kg,
            com_in_flange_m=nominal.apply(np.array(settings.com_in_sensor_mm) * MM),
        )
        compliance = scenario.compliance
        self._robot_n_m = np.diag(
            [compliance.lateral_n_m] * 2
            + [compliance.axial_n_m]
            + [compliance.turning_nm_rad] * 2
            + [compliance.yaw_nm_rad]
        )
        self.nominal_fit = nominal_fit(scenario.fit)
        self.loads = 0
        self.load()

    def load(self) -> dict[str, Any]:
        """Bring the next peg and the next face with its hole; peaks and slip begin anew."""
        self.loads += 1
        self.part = draw_part(self.scenario, self.seed, self.loads)
        self._hole = self.part.cell_T_hole.as_matrix()
        self._hole_inverse = inverse_matrix(self._hole)
        self._flange_T_peg = self.part.flange_T_peg.as_matrix()
        self.peaks = ForcePeaks()
        self._contact = np.zeros(6)
        flange = self.flange(self.scenario.peg.carried_by).as_matrix()
        self.peg = HeldPeg(
            fit_with(self.scenario.fit, self.faults),
            self._robot_n_m,
            pose_of(self._hole_inverse @ flange @ self._flange_T_peg),
            grip_n=grip_force_n(self.scenario, self.faults),
        )
        return {"load": self.loads}

    def commands(self) -> Mapping[str, Command]:
        """The hands of the operator on the control port."""
        return {"load": self.load}

    def faults_changed(self) -> None:
        """Faults of hole and fingers act at once."""
        # The peg stays where it is: a fault of the hole is injected while it stands there.
        self.peg.change(fit_with(self.scenario.fit, self.faults))
        self.peg.hold_with(grip_force_n(self.scenario, self.faults))

    # -- forces ---------------------------------------------------------------------------------
    def load_on(self, sensor: str, flange: Array, *, moving: bool) -> Array:
        """Weight and inertia of the tool, and what the hole does to the peg."""
        if sensor != self.scenario.peg.force_sensor:
            return np.zeros(6)
        self._tool.advance(flange, moving=moving)
        self.peg.follow(pose_of(self._hole_inverse @ flange @ self._flange_T_peg), STEP_S)
        self.peaks.take(self.peg.wrench[None, :])
        return np.asarray(self._tool.load + self._at_sensor(flange))

    def _at_sensor(self, flange: Array) -> Array:
        wrench = self.peg.wrench
        if not wrench.any():
            return wrench
        sensor = flange @ self._flange_T_sensor.as_matrix()
        force, torque = self._hole[:3, :3] @ wrench[:3], self._hole[:3, :3] @ wrench[3:]
        tip = self._hole[:3, :3] @ np.array(self.peg.pose[:3]) + self._hole[:3, 3]
        torque = torque + np.cross(tip - sensor[:3, 3], force)
        turned = sensor[:3, :3].T
        return np.concatenate([turned @ force, turned @ torque])

    # -- views and truth ------------------------------------------------------------------------
    def bodies_before(self, camera_T_cell: RigidTransform) -> Iterable[Seen]:  # noqa: ARG002
        """Nothing: the hole is where no camera sees it."""
        return ()

    def truth_report(self) -> dict[str, Any]:
        """The peg against its hole, seated or not, slip, and the largest forces: mm, degrees, N."""
        peg, part = self.peg, self.part
        x, y, z, tilt_x, tilt_y, yaw = peg.pose
        wanted = self.nominal_fit
        # Beside the mouth the tip may hang below the face of a plug without being in anything.
        within = math.hypot(x, y) < peg.fit.mouth_radius_m
        depth_mm = -z / MM if within else 0.0
        wrong = [name for name in _HOLE_FAULTS if self.faults.active(name)]
        # The depth is that of the hole that was wanted: a peg deep in a wrong one is not seated.
        seated = within and depth_mm > wanted.depth_m / MM - _SEAT_MM and not wrong
        return {
            "load": self.loads,
            "cell_T_flange_mm_deg": to_written(self.flange(self.scenario.peg.carried_by)),
            "cell_T_hole_mm_deg": to_written(part.cell_T_hole),
            "flange_T_peg_mm_deg": to_written(part.flange_T_peg),
            "hole_T_tip_mm": [x / MM, y / MM, z / MM],
            "tilt_deg": math.degrees(math.hypot(tilt_x, tilt_y)),
            "yaw_deg": math.degrees(yaw),
            "depth_mm": depth_mm,
            "seat_depth_mm": wanted.depth_m / MM,
            "seated": seated,
            "hole_faults": wrong,
            "slip_mm": peg.slip_m / MM,
            "touching": bool(peg.touching),
            "force_n": peg.wrench.tolist(),
            "peak_force_n": _by_window(self.peaks.force_n),
            "peak_moment_nm": _by_window(self.peaks.moment_n_m),
            "unsolved_steps": peg.failures,
            "unsolved_percent": 100.0 * peg.unsolved_share,
        }


def _by_window(peaks: dict[int, float]) -> dict[str, float]:
    return {f"{window}_ms": value for window, value in peaks.items()}
