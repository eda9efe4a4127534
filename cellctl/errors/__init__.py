"""The faults of the core, one numbered tree; one module a block of numbers.

Those of a process or of another plug-in stand in the module ``faults`` of its package.

CellError
├── ConfigError       1xx   errors.config       configuration, files, arguments
│   └── PlanningError  12x   errors.config       planning of a cell, offline
├── LinkError         2xx   errors.link         connections to devices
│   └── CameraError   22x   errors.camera       cameras behind the library of their maker
├── RobotError        3xx   errors.robot        controllers and motion
├── GripperError      34x   errors.gripper      grippers
├── DigitalIoError    35x   errors.digital_io   digital inputs and outputs
├── VisionError       4xx   errors.vision       images, holes, part poses
├── ForceError        5xx   errors.force        sensor, guard, mating
├── StreamedContactError 57x errors.streamed_contact  contact under a stream of setpoints
├── CalibrationError  6xx   errors.calibration  calibration and its gate
├── LineError         7xx   errors.line         line PLC and commands
│   └── LocalError    71x   errors.local        operator commands on the cell's PC, 74x
├── RecordsError      8xx   errors.records.store  run store and artefacts
│   └── FleetError     83x  errors.records.fleet  records of many cells in one database
└── InternalError     9xx   errors.internal     cellctl itself
"""

from cellctl.errors import (
    calibration,
    camera,
    config,
    digital_io,
    force,
    gripper,
    internal,
    line,
    link,
    local,
    records,
    robot,
    streamed_contact,
    vision,
)
from cellctl.errors.base import CellError, Reaction, catalogue

__all__ = [
    "CellError",
    "Reaction",
    "calibration",
    "camera",
    "catalogue",
    "config",
    "digital_io",
    "force",
    "gripper",
    "internal",
    "line",
    "link",
    "local",
    "records",
    "robot",
    "streamed_contact",
    "vision",
]
