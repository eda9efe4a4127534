"""The list of `cellctl --help`, without loading what it lists.

Together the commands load OpenCV, scipy and matplotlib for seconds, and a list of names needs none
of them. A test compares the names with the commands that there are.
"""

from collections.abc import Iterator
from dataclasses import dataclass

from cellctl.cli.help.help_groups import OFFLINE, OPERATE

_CELL, _RECORDS, INSTALLED = "The cell", "Records and faults", "From installed packages"


@dataclass(frozen=True, slots=True)
class Listed:
    """One line of the help."""

    name: str
    panel: str
    summary: str


CELL = (
    Listed("check", _CELL, "Check a cell file; exit code 1, with every error and what is allowed."),
    Listed("keys", _CELL, "All keys of a cell file, with those of drivers and processes; or some."),
    Listed("doctor", _CELL, "Examine this PC: users, rights, clock, disk, network; with remedies."),
    Listed("run", _CELL, "Run the cell until SIGTERM or Ctrl-C."),
    Listed("demo", _CELL, "Start a fake cell, daemon and line PLC and run one job."),
    Listed("robot", _CELL, "Listen to one robot and print what it says. Moves nothing."),
    Listed("teach", _CELL, "Capture taught poses; the arm is moved by hand or pendant."),
    Listed("service-limits", _CELL, "Print a drop-in for cellctl.service: only this cell's peers."),
    Listed("grab", _CELL, "Save images as PNG, each exposure with a JSON file; moves nothing."),
    Listed("focus", _CELL, "Show sharpness, light, overlap and what is found, live."),
)
OPERATOR = (
    Listed("status", OPERATE, "State, faults with their remedy, calibrations, links and last run."),
    Listed("clear", OPERATE, "Aborted to Stopped: release the fault, once its cause is removed."),
    Listed("reset", OPERATE, "Stopped or Completed to Idle: robots are released."),
    Listed("start", OPERATE, "Assemble a part; only in Production mode."),
    Listed(
        "procedure",
        OPERATE,
        "Calibrate, identify or verify; only in Maintenance mode.",
    ),
    Listed("hold", OPERATE, "Pause at the next safe point."),
    Listed("unhold", OPERATE, "Go on after a Hold, beginning with new measurements."),
    Listed("stop", OPERATE, "End motion and run; obeyed at any time, whoever is in control."),
    Listed("abort", OPERATE, "Stop and latch all robots at once; obeyed at any time."),
    Listed("mode", OPERATE, "Change the mode, in Stopped, Idle or Aborted."),
    Listed("alarms", OPERATE, "List and acknowledge the alarms of the running daemon."),
)
FILES = (
    Listed("runs", _RECORDS, "Look into the run store."),
    Listed("calibrations", _RECORDS, "Look into the calibrations of the run store."),
    Listed("replay", _RECORDS, "Compute every measurement of a run anew from its recordings."),
    Listed("faults", _RECORDS, "All faults, installed packages' included; or one in words."),
    Listed("audit", _RECORDS, "Who did what: commands, gauges, acknowledgements."),
    Listed("fleet", _RECORDS, "Records of many cells in one PostgreSQL: deliver, search, verify."),
    Listed("calibrate", OFFLINE, "Calibrate from files."),
    Listed("measure", OFFLINE, "Measure the named holes of a feature file in a stereo pair."),
    Listed("plan", OFFLINE, "Check and plan the moves of a cell by its model."),
    Listed("judge-insertion", OFFLINE, "Whether a part is inserted, by its recorded curve."),
    Listed("study", OFFLINE, "Run a trial of a recipe over thousands of seeds on Dask."),
    Listed("identify-payload", OFFLINE, "Identify mass, centre of mass and offsets from wrenches."),
)


BROUGHT = (
    Listed("devices", _CELL, "List the cameras that GenTL producers see; opens none of them."),
    Listed("measure-connector", OFFLINE, "Measure the contacts of a connector in one image."),
    Listed("plan-plug", OFFLINE, "Where the flange goes to plug a connector, with its error."),
)
"""Those of the processes and drivers that come with cellctl."""


def installed(names: list[str]) -> Iterator[Listed]:
    """Commands that processes and drivers bring. The words of other packages' would load them."""
    words = {listed.name: listed for listed in BROUGHT}
    for name in names:
        told = f"`cellctl {name} --help` says what it does."
        yield words.get(name, Listed(name, INSTALLED, told))
