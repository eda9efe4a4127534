"""The calibration kinds of this process that its chain of poses uses."""

# A fault stands in ``invalidated_by`` when what caused it has moved what the calibration holds
# for. A robot reports a collision as an error of its controller.
from typing import Any

from cellctl.calibration.solvers.hand_eye.hand_eye_result import HandEyeResult
from cellctl.calibration.solvers.single_camera.single_camera_result import SingleCameraResult
from cellctl.calibration.solvers.tool.tool import ToolResult
from cellctl.calibration.store.kind import CalibrationKind
from cellctl.errors.robot import ControllerFault
from cellctl.processes.antenna_module.chain.reference.taught_reference import TaughtReference
from cellctl.processes.antenna_module.chain.teaching.taught import PlugCorrection
from cellctl.processes.antenna_module.chain.teaching.tool_turn import ToolTurnResult
from cellctl.processes.antenna_module.faults.calibration import (
    ArmMoved,
    FixedCameraMoved,
    FlangeCameraMoved,
    GripperMarksMoved,
    ReferenceMoved,
    ReferencePlateMoved,
)
from cellctl.processes.antenna_module.faults.plugging import PlugOverForce
from cellctl.processes.antenna_module.roles import CAMERA_1, CAMERA_2

CAMERA_1_INTRINSICS = CalibrationKind(
    name="camera_1", parse=SingleCameraResult.from_record, device=CAMERA_1
)
CAMERA_2_INTRINSICS = CalibrationKind(
    name="camera_2", parse=SingleCameraResult.from_record, device=CAMERA_2
)

FLANGE_CAMERA = CalibrationKind(
    name="flange_T_cam1",
    parse=HandEyeResult.from_record,
    invalidated_by=frozenset({ControllerFault, FlangeCameraMoved, ArmMoved, ReferenceMoved}),
)
"""Camera I on the flange."""

FIXED_CAMERA = CalibrationKind(
    name="base_T_cam2",
    parse=HandEyeResult.from_record,
    invalidated_by=frozenset({ControllerFault, FixedCameraMoved, ArmMoved, ReferenceMoved}),
)
"""Camera II beside the robot."""

PLUG_CORRECTION = CalibrationKind(
    name="plug_correction",
    parse=PlugCorrection.from_record,
    invalidated_by=frozenset(
        {
            ControllerFault,
            FlangeCameraMoved,
            GripperMarksMoved,
            ArmMoved,
            ReferenceMoved,
            # The gripper was pressed harder than it is made for, its marks with it.
            PlugOverForce,
        }
    ),
    required=False,
    per_recipe=True,
)
"""What teaching has found, for the connector of each recipe. A camera II that moved is not among
its faults: marks and plug lie in one picture of it."""

REFERENCE = CalibrationKind(
    name="reference",
    parse=TaughtReference.from_record,
    invalidated_by=frozenset(
        {
            FixedCameraMoved,
            FlangeCameraMoved,
            GripperMarksMoved,
            ReferencePlateMoved,
            ArmMoved,
            ReferenceMoved,
        }
    ),
    required=False,
)
"""Where axis, marks and plate are; the settings say whether a run needs it. Whatever has moved
stays where it is then, so all of these faults ask for a new one."""

TOOL_TURN = CalibrationKind(
    name="tool_turn",
    parse=ToolTurnResult.from_record,
    invalidated_by=frozenset({GripperMarksMoved}),
    procedures=(207,),
    required=False,
    serves_production=False,
)
"""The gripper's marks beside the flange axis. Nothing is plugged by it: the frame of the tool drops
out of every scheme. It says whether gripper and drawing are those of each other."""

TOOL = CalibrationKind(
    name="tool",
    parse=ToolResult.from_record,
    invalidated_by=frozenset({ControllerFault, GripperMarksMoved}),
    procedures=(208,),
    required=False,
    serves_production=False,
)
"""The gripper's tip by touches, as good as a touch: for picking, and for jogging about the tip."""

CALIBRATIONS: tuple[CalibrationKind[Any], ...] = (
    CAMERA_1_INTRINSICS,
    CAMERA_2_INTRINSICS,
    FLANGE_CAMERA,
    FIXED_CAMERA,
    REFERENCE,
    PLUG_CORRECTION,
    TOOL_TURN,
    TOOL,
)
