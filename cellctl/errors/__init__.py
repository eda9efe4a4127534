"""Every fault of the cell, one numbered tree; one module a block of numbers.

CellError
├── ConfigError       1xx   errors.config       configuration, files, arguments
│   └── PlanningError  12x   errors.planning     planning of a cell, offline
├── LinkError         2xx   errors.link         connections to devices
│   └── CameraError   22x   errors.camera       cameras behind the library of their maker
├── RobotError        3xx   errors.robot        controllers and motion
├── GripperError      34x   errors.gripper      grippers
├── DigitalIoError    35x   errors.digital_io   digital inputs and outputs
├── VisionError       4xx   errors.vision       images, holes, part poses
│   └── ConnectorError 46x  errors.connector    connectors and their contacts in one image
├── ForceError        5xx   errors.force        sensor, guard, mating
├── ByTouchError      54x   errors.by_touch     holes that are found by touch
├── StreamedContactError 57x errors.streamed_contact  contact under a stream of setpoints
├── PluggingError     56x   errors.plugging     plan and insertion of a plug
├── CalibrationError  6xx   errors.calibration  calibration and its gate
│   └── ReferenceMoved 64x  errors.plug_calibration  plugging by two cameras
├── LineError         7xx   errors.line         line PLC and commands
│   └── LocalError    71x   errors.local        operator commands on the cell's PC
├── RecordsError      8xx   errors.records      run store and artefacts
└── InternalError     9xx   errors.internal     cellctl itself
"""

from cellctl.errors import (
    by_touch,
    calibration,
    camera,
    config,
    connector,
    digital_io,
    force,
    gripper,
    internal,
    line,
    link,
    local,
    planning,
    plug_calibration,
    plugging,
    records,
    robot,
    streamed_contact,
    vision,
)
from cellctl.errors.base import CellError, Reaction, catalogue

__all__ = [
    "CellError",
    "Reaction",
    "by_touch",
    "calibration",
    "camera",
    "catalogue",
    "config",
    "connector",
    "digital_io",
    "force",
    "gripper",
    "internal",
    "line",
    "link",
    "local",
    "planning",
    "plug_calibration",
    "plugging",
    "records",
    "robot",
    "streamed_contact",
    "vision",
]
