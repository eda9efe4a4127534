"""1xx: configuration, files and arguments; planning of a cell, offline (12x)."""

from cellctl.errors.base import CellError, Reaction


class ConfigError(CellError):
    """What the user wrote is wrong."""

    reaction = Reaction.STOP


class ConfigUnreadable(ConfigError):
    """The cell file cannot be read or is not TOML."""

    number = 101
    text = "Configuration file cannot be read"
    cause = "Missing file, no permission, or a syntax error in the TOML."
    remedy = "Check name and folder of the file; of a syntax error the detail has line and column."


class ConfigInvalid(ConfigError):
    """Keys or values of the cell file, or of its model, are not allowed."""

    number = 102
    text = "Configuration is not valid"
    cause = "Unknown or missing keys, or values outside their range."
    remedy = (
        "The detail names file and key. Of a cell file `cellctl check FILE` lists every error with "
        "the allowed range; a model (`*.model.toml`) is described in docs/planning.md, and "
        "`cellctl plan check` with the cell file reads it again."
    )


class UnknownDriver(ConfigError):
    """A driver named in the cell file is not installed."""

    number = 103
    text = "Driver is not available"
    cause = "Misspelt name, or the package that holds the driver or its vendor SDK is missing."
    remedy = "Use one of the names in the detail or install the driver."


class MixedSimulation(ConfigError):
    """Real and simulated devices in one cell."""

    number = 104
    text = "Real and simulated devices are mixed"
    cause = "Some devices are marked `simulated = true` and others are not."
    remedy = "Mark all devices of a simulated cell, or none."


class DeviceNotInCell(ConfigError):
    """A command names a device that the cell file does not have."""

    number = 106
    text = "Device is not in the cell file"
    cause = "Misspelt name, another kind of device, or another cell file."
    remedy = "Use one of the names in the detail."


class FileInvalid(ConfigError):
    """A file given to a command is not what it should be."""

    number = 105
    text = "Input file is not valid"
    cause = "Wrong file, wrong format, or damaged content."
    remedy = "See the detail for the place in the file."


class OutputNotWritten(ConfigError):
    """A command cannot write the file that it was asked for."""

    number = 107
    text = "File cannot be written"
    cause = "No such folder, no permission, or a full disk."
    remedy = "Name another file, or make the folder; see the detail."


class PlanningError(ConfigError):
    """What is planned does not fit the cell; nothing is written then."""


class PlanningNotInstalled(PlanningError):
    """The libraries of the extra ``plan`` are missing."""

    number = 121
    text = "Planning is not installed"
    cause = "The extra `plan` of the package was left out: the daemon does not need it."
    remedy = "Install cellctl with the extra `plan`, on any PC that has the cell file."


class MeshNotUsable(PlanningError):
    """A surface of the model cannot be read or is not closed."""

    number = 122
    text = "Mesh cannot be used"
    cause = "The file is missing, of an unknown format, or its surface has holes."
    remedy = "Export the body again as a closed surface, or write a box or a capsule around it."


class SizeImplausible(PlanningError):
    """A body is far larger or smaller than anything in a cell."""

    number = 123
    text = "Size of a body is implausible"
    cause = "Figures in another unit: metres read as millimetres, or the other way round."
    remedy = "State the unit of the mesh, or correct the figures in the detail."


class ArmNotDescribed(PlanningError):
    """Nothing says how the arm is built."""

    number = 124
    text = "Arm of the model is not described"
    cause = "The robot is not in the cell file, or its driver's settings have no dh table."
    remedy = "Correct the name, or write the dh table into the settings of the robot."


class PlaceUnreachable(PlanningError):
    """The arm cannot stand where a move leads."""

    number = 125
    text = "Place cannot be reached"
    cause = "Out of reach, beyond a joint's limit or outside the workspace in the cell file."
    remedy = "Move the part or the base, teach another pose, or correct the bounds."


class BodiesCollide(PlanningError):
    """Two bodies of the model touch."""

    number = 126
    text = "Bodies meet"
    cause = "A pose or the way to it leads through something that the model has there."
    remedy = "Teach another pose or plan a way (`cellctl plan paths`); or correct the model."


class ClearanceTooSmall(PlanningError):
    """Two bodies come nearer to each other than their margins."""

    number = 127
    text = "Clearance is smaller than the margin"
    cause = "The gap at the pose or on the way is narrower than the margins of the model ask for."
    remedy = "Widen the gap, or state smaller margins if arms and model are that exact."


class NoFreeWay(PlanningError):
    """No way between two places was found."""

    number = 128
    text = "No free way was found"
    cause = "The gaps are narrower than the margins, or the search was not long enough."
    remedy = "Look at the model with `cellctl plan show`; search longer; move what is in the way."


class NoMovesStated(PlanningError):
    """The processes of a cell state no move that a model could be held against."""

    number = 129
    text = "No moves to check"
    cause = "No recipe's process states its moves yet, or the cell file has no recipe."
    remedy = "Nothing is known to be free: try every move at low speed. See docs/planning.md."


class HeadNotDescribed(PlanningError):
    """Nothing says what a head sees."""

    number = 130
    text = "Head is not described"
    cause = "The model has no section for it, or it is not calibrated or not mounted on an arm."
    remedy = "Write [stereo_cameras.NAME] into the model, and calibrate the head."


class NoViewpoint(PlanningError):
    """No pose of a head fulfils everything that a measurement asks for."""

    number = 131
    text = "No viewpoint was found"
    cause = "Every pose that was tried breaks a condition; the detail counts which ones."
    remedy = "Move the base or the part, choose other holes, or change what the model demands."


class NoViewsStated(PlanningError):
    """The processes of a cell state no measurement that could be planned."""

    number = 132
    text = "No measurements to plan"
    cause = "No recipe's process states what its heads measure, or the cell file has no recipe."
    remedy = "Teach the poses of the cameras by hand. See docs/planning.md."


class ZoneTooSmall(PlanningError):
    """Two arms could meet while one of them is outside of its box of their zone."""

    number = 133
    text = "Zone does not keep two arms apart"
    cause = "The box of one arm does not hold a place at which a body of the other could meet it."
    remedy = "Widen the box to the place in the detail and 100 mm more, or keep the arm from there."


class StudyUnavailable(ConfigError):
    """The trials of a study are not installed."""

    number = 108
    text = "Studies need a checkout of cellctl"
    cause = "cellctl was installed as a package, without the campaigns and the fake cells' files."
    remedy = "Run `cellctl study` of an installed release or of a checkout."
