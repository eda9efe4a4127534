"""The bench with its parts, each at its true place: what its operator handles."""

from dataclasses import replace
from typing import Any

from scipy.spatial.transform import RigidTransform

from fakes.scenes.antenna_bench.boards import plate_pose
from fakes.scenes.antenna_bench.gripping import ModulePlace, Place
from fakes.scenes.antenna_bench.mating import PlugAtSocket, mount_of
from fakes.scenes.antenna_bench.parts import draw_parts
from fakes.scenes.antenna_bench.scenario import BenchScenario
from fakes.scenes.antenna_bench.shifts import shifted
from fakes.world.flaws.warmth import warmed
from fakes.world.frames import from_written, stream
from fakes.world.truth import drawn_spread
from fakes.world.world import World


class BenchWorld(World[BenchScenario]):
    """Module, panel, marks and plate. ``AntennaBench`` adds the forces, the views and the
    operator."""

    def __init__(self, scenario: BenchScenario, seed: int) -> None:
        super().__init__(scenario, seed)
        gripper = scenario.gripper
        spread = drawn_spread(stream(scenario.hardware_seed, "marks"), gripper.marks_spread)
        self._flange_T_marks = from_written(gripper.flange_T_marks_mm_deg) * spread
        self._cell_T_plate = plate_pose(
            scenario, self.truth.cameras[scenario.fixed_camera].mount_T_camera
        )
        self.mount = mount_of(gripper.lateral_n_mm, gripper.axial_n_mm)
        self.loads = self._warmings = 0
        self.load()

    def load(self) -> dict[str, Any]:
        """Lay the next module on the tray and bring the next panel."""
        self.loads += 1
        self.parts = draw_parts(self.scenario, self.seed, self.loads, self.faults)
        gripper = self.scenario.gripper
        place: Place = "absent" if self.faults.active("empty_tray") else "tray"
        self.module = ModulePlace(
            gripper, self.seed + self.loads, place, self.parts.cell_T_tray_plug,
            from_written(gripper.flange_T_plug_mm_deg), self.faults,
        )  # fmt: skip
        self.mating = PlugAtSocket(self.parts.pair, self.mount)
        return {"load": self.loads}

    def warm(self, kelvin: float) -> dict[str, Any]:
        """The arm's links take temperatures that differ by so much, from the next motion on."""
        self._warmings += 1
        arm = self.arms[self.scenario.gripper.carried_by]
        rng = stream(self.seed, "warmth", self._warmings)
        built = self.truth.robots[self.scenario.gripper.carried_by].links
        arm.truth = replace(arm.truth, links=warmed(built, rng, kelvin))
        return {"warmings": self._warmings}

    def rests_at(self, cell_T_flange: RigidTransform) -> RigidTransform:
        """True cell_T_plug: where the springs leave it."""
        cell_T_plug = self.module.now(cell_T_flange)
        if self.module.place != "gripper":
            return cell_T_plug
        socket = self.parts.cell_T_socket
        return socket * self.mating.rests_at(socket.inv() * cell_T_plug)

    @property
    def flange_T_marks(self) -> RigidTransform:
        """Where the gripper's marks are."""
        return shifted(self.faults, "marks_shifted", self._flange_T_marks)

    @property
    def cell_T_plate(self) -> RigidTransform:
        """Where the reference plate is."""
        return shifted(self.faults, "plate_shifted", self._cell_T_plate)

    def camera_pose(self, camera: str) -> RigidTransform:
        """True cell_T_camera, slipped or not."""
        pose = super().camera_pose(camera)
        if camera == self.scenario.fixed_camera:
            return shifted(self.faults, "camera_2_shifted", pose)
        flange = self.flange(self.scenario.gripper.carried_by)
        return flange * shifted(self.faults, "camera_1_shifted", flange.inv() * pose)
