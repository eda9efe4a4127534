"""The coupler on which valve and sensors of a pneumatic gripper are wired."""

from collections.abc import Callable, Mapping
from typing import Final

from fakes.wire.couplers.coupler import CouplerServer
from fakes.world.gripper import PneumaticJaws

OPEN_COIL, CLOSE_COIL = 0, 1
SENSORS: Final = {"opened": 0, "closed": 1, "part": 2}
"""Input addresses."""


def gripper_coupler(
    jaws: PneumaticJaws, clock: Callable[[], float], *, watchdog_ms: int = 500
) -> CouplerServer:
    """A coupler that carries one gripper and nothing else."""

    def sensors(time_s: float) -> Mapping[int, bool]:
        return {SENSORS[name]: value for name, value in jaws.sensors(time_s).items()}

    def drive(time_s: float, outputs: Mapping[int, bool]) -> None:
        jaws.drive(time_s, open_coil=outputs[OPEN_COIL], close_coil=outputs[CLOSE_COIL])

    return CouplerServer(
        clock,
        inputs=sensors,
        output_addresses=(OPEN_COIL, CLOSE_COIL),
        on_outputs=drive,
        watchdog_ms=watchdog_ms,
    )
