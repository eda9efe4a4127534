"""What the controller of a collaborative arm does with calls. No sockets.

Written from docs/protocols/siasun-rpc.md. Where that page says that something is not known, this
controller does what is worst for a driver: it has no latch, obeys every client, and goes on moving
when a client that never sent a heartbeat goes away.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
from scipy.spatial.transform import RigidTransform

from fakes.faults import FaultBoard
from fakes.wire.duco.faults import DUCO_FAULTS
from fakes.wire.duco.poses import from_six, to_six
from fakes.wire.duco.tasks import TaskEnd, Tasks
from fakes.world.robot import RefusedMotionError, RobotArm

Client = int
"""A connection, as long as it stands."""
REMOTE, ENABLED, SAFETY_RUN, SAFETY_STOP_0 = 2, 6, 5, 9
MOST_LOAD_KG = 35.0
"""Greatest load of the family (manual), beyond which the controller refuses a call."""


class DucoLogic:
    """Every call takes the connection it came from. Times are those of ``clock``."""

    def __init__(
        self,
        arm: RobotArm,
        clock: Callable[[], float],
        *,
        version: str = "V3.9.1",
        tool: str = "flange",
        work_frame: str = "base",
    ) -> None:
        self.arm = arm
        self.clock = clock
        self.version = version
        self.faults = FaultBoard("robot", DUCO_FAULTS)
        self.tasks = Tasks()
        self.words = [0] * 33
        self.errors: list[str] = []
        self.stops = 0
        """Stops that were asked for."""
        self.motions = 0
        """Calls that were told to move the arm."""
        self.tool_load = [0.0] * 4
        """Mass (kg) and centre of mass (m) of the tool that is chosen at the pendant."""
        self.tool_frame, self.work_object = [0.0] * 6, [0.0] * 6
        """Frames that are chosen there, in m and rad."""
        self._frames = {"tool": tool, "work object": work_frame}
        self.servo_s = 0.008
        """Time in which the arm reaches a streamed setpoint that is one small step away."""
        self._deadlines: dict[Client, float] = {}
        self._stopping = False

    # -- state ----------------------------------------------------------------------------------
    def moving(self) -> bool:
        """True until standstill."""
        return self.arm.moving(self.clock())

    def states(self) -> list[int]:
        """Robot, program, safety, mode."""
        wrong = self.faults.active
        return [
            5 if wrong("disabled") else ENABLED,
            0,
            SAFETY_STOP_0 if wrong("emergency_stop") else SAFETY_RUN,
            0 if wrong("manual_mode") else REMOTE,
        ]

    def pose(self) -> list[float]:
        """Flange in the base: metres and radians."""
        moving_axes = self.faults.active("euler") is not None
        return to_six(self.arm.encoder_matrix(self.clock()), moving_axes=moving_axes)

    def joints(self) -> list[float]:
        """Joints of the encoders in radians."""
        return [float(angle) for angle in self.arm.joints(self.clock())]

    def frame_known(self, tool: str, work_frame: str) -> bool:
        """Whether both frames exist; an empty name means the one chosen at the pendant."""
        return tool == self._frames["tool"] and work_frame == self._frames["work object"]

    def tick(self) -> None:
        """Watch heartbeats and safety, and end the task of an arm that stands."""
        now_s = self.clock()
        for client, deadline_s in list(self._deadlines.items()):
            if now_s > deadline_s:
                del self._deadlines[client]
                self._halt()
        if self.faults.active("emergency_stop") and self.moving() and not self._stopping:
            self._halt()
        if not self.moving():
            self.tasks.end(TaskEnd.STOPPED if self._stopping else TaskEnd.FINISHED)
            self._stopping = False

    # -- calls ----------------------------------------------------------------------------------
    def heartbeat(self, client: Client, time_ms: int) -> None:
        """Take note that this client must be heard again within a time from now on."""
        self._deadlines[client] = self.clock() + time_ms / 1000.0

    def stop(self) -> int:
        """Stop all tasks; the number of the task that does it."""
        self.stops += 1
        if not self.faults.active("stop_ignored"):
            self._halt()
        return self.tasks.begin(TaskEnd.FINISHED).number

    def set_load(self, load: list[float]) -> int:
        """set_load_data: mass (kg) and centre of mass (m)."""
        if not 0.0 <= load[0] <= MOST_LOAD_KG:
            return self._refuse(TaskEnd.PARAMETERS, f"load of {load[0]:g} kg")
        self.tool_load = list(load)
        return self.tasks.begin(TaskEnd.FINISHED).number

    def move_joint(self, joints_rad: list[float], percent: float) -> int:
        """movej, by percent of the rated speed."""
        target = np.array(joints_rad)
        return self._move(lambda: self.arm.start_joint(self.clock(), target, percent))

    def move_linear(
        self, pose: list[float], speed_m_s: float, acceleration_m_s2: float, frames: tuple[str, str]
    ) -> int:
        """Straight move to a pose (movel)."""
        if not self.frame_known(*frames):
            return self._refuse(TaskEnd.PARAMETERS, f"unknown frame {frames}")
        target = RigidTransform.from_matrix(self._matrix(pose))
        return self._move(
            lambda: self.arm.start_linear(self.clock(), target, speed_m_s, acceleration_m_s2)
        )

    def servo(self, pose: list[float], frames: tuple[str, str]) -> int:
        """servoj_pose: a new target in place of the one before."""
        if self.faults.use("minus_one"):
            return -1
        if self.faults.use("servo_lost"):
            return self.tasks.begin(TaskEnd.IDLE).number
        if not self.frame_known(*frames):
            return self._refuse(TaskEnd.PARAMETERS, f"unknown frame {frames}")
        if self._stopping:
            return self.tasks.begin(TaskEnd.STOPPED).number
        return self._begin(lambda: self.arm.follow(self.clock(), self._matrix(pose), self.servo_s))

    def _move(self, start: Callable[[], None]) -> int:
        self.tick()  # so that a stop that has just ended is not taken for one of this motion
        self.motions += 1
        if self.faults.use("minus_one"):
            return -1
        if fault := self.faults.use("task_end"):
            return self._refuse(int(fault.number("state", TaskEnd.ERROR)), "injected end")
        if self.moving():
            return self._refuse(TaskEnd.ILLEGAL, "another motion is running")
        return self._begin(start)

    def _begin(self, start: Callable[[], None]) -> int:
        robot, _, safety, mode = self.states()
        if (robot, safety, mode) != (ENABLED, SAFETY_RUN, REMOTE):
            return self._refuse(TaskEnd.ILLEGAL, "robot is not ready")
        try:
            start()
        except RefusedMotionError as refusal:
            return self._refuse(TaskEnd.ILLEGAL, refusal.reason)
        return self.tasks.begin().number

    def _refuse(self, state: int, text: str) -> int:
        self.errors = [text]
        return self.tasks.begin(state).number

    def _halt(self) -> None:
        if self.moving():
            self.arm.stop(self.clock())
            self._stopping = True

    def _matrix(self, pose: list[float]) -> Any:
        return from_six(pose, moving_axes=self.faults.active("euler") is not None)
