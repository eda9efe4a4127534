"""71x: the local API, by which operators at the cell's PC reach the daemon; 74x: devices that are
asked without it."""

from cellctl.errors.base import Reaction
from cellctl.errors.line import LineError


class LocalError(LineError):
    """Something between an operator's command and the daemon."""

    reaction = Reaction.STOP


class LocalApiInUse(LocalError):
    """Another daemon listens on the socket."""

    number = 711
    text = "Another daemon serves the local API"
    cause = "A second cellctl was started with the same socket."
    remedy = "Stop the other daemon, or give this one its own data_dir or local_api.socket."


class CannotServeLocally(LocalError):
    """The socket cannot be made."""

    number = 712
    text = "The socket of the local API cannot be opened"
    cause = "Folder missing or not writable, a path beyond 107 bytes, a file that is no socket in "
    cause += "its place, or a group that does not exist or that the daemon does not belong to."
    remedy = "Check local_api.socket and local_api.group in the cell file."


class MessageMalformed(LocalError):
    """A line is not one of the local API's messages; nothing was done."""

    number = 713
    text = "Message of the local API not understood"
    cause = "Mistyped value, or command and daemon of different versions."
    remedy = "See the detail; use the cellctl that the daemon was started with."
    reaction = Reaction.WARN


class DaemonNotReached(LocalError):
    """Nobody answers on the socket."""

    number = 714
    text = "The daemon does not answer"
    cause = "It is not running, uses another socket, or this user is not in its group."
    remedy = "Start it, name its socket with --socket or CELLCTL_SOCKET, or ask for membership of "
    remedy += "the group."


class DaemonSlow(LocalError):
    """The daemon has taken the connection, and has not answered in time."""

    number = 721
    text = "The daemon is slow to answer"
    cause = "Its process runs, and other programs want the processors, its disk is slow, or it "
    cause += "hangs or was suspended."
    remedy = "If anything moves that should stand, press the emergency stop. Ask again by "
    remedy += "`cellctl status` before you repeat a command: it may have been taken. On a busy PC "
    remedy += "end other programs, or move them to another PC. If the daemon answers nothing for a "
    remedy += "minute, look for `event loop held` in its log, then restart it while the arms stand."


class StopNotDelivered(LocalError):
    """A Stop or an Abort of which nobody says that it was taken: the arms may move on."""

    number = 720
    text = "Nobody has confirmed the stop: do not count on it"
    cause = "The daemon does not run, hangs, uses another socket, or this user is not in its group."
    remedy = "If anything moves or presses, press the emergency stop. Robots whose daemon has died "
    remedy += "stop by themselves, for want of its sign of life, but an arm in contact stays there "
    remedy += "and presses. Then find the daemon: `cellctl status`, `systemctl status cellctl`."


class CommandRefused(LocalError):
    """The daemon will not do it, and says why."""

    number = 715
    text = "The cell refuses the command"
    cause = "See the detail; the codes are the line PLC's, docs/register-map.md."
    remedy = "`cellctl status` says what to do next and which commands are permitted now; why each "
    remedy += "of the others is refused stands in `cellctl status --json`."
    reaction = Reaction.WARN


class CommandMissedItsGoal(LocalError):
    """The command was taken, and the cell ended elsewhere, or not in time."""

    number = 716
    text = "The cell did not get where the command leads"
    cause = "A fault, another command, or a state that takes longer than the command waits."
    remedy = "Look at `cellctl status`: a fault is shown there with its remedy."
    reaction = Reaction.WARN


class NotThePage(LocalError):
    """A command on behalf of a person that this user may not bring, or not in this way."""

    number = 717
    text = "A command on behalf of a person is not accepted"
    cause = "Its sender is not the user of the operator page's process, or its key was used before."
    remedy = "Set local_api.page_user in the cell file to the user that cellctl-hmi runs as."
    reaction = Reaction.WARN


class PageSettingsWrong(LocalError):
    """The settings of the operator page cannot be used."""

    number = 718
    text = "The settings of the operator page cannot be used"
    cause = "The file is missing, not TOML, or a value in it is wrong; see the detail."
    remedy = "Correct the file; docs/operator-page.md lists its keys."


class PageCannotServe(LocalError):
    """The page's process cannot listen."""

    number = 719
    text = "The operator page cannot be served"
    cause = "Its port is taken by another program, or the address is not of this PC."
    remedy = "Give another port or address in the settings of the page."


class CellInUse(LocalError):
    """Somebody has the connections of the cell already, and would lose them."""

    number = 740
    text = "The devices of this cell are not asked: they are in use"
    cause = "The daemon of this cell runs, or another program has the ports of the cell file."
    remedy = "Ask the daemon: `cellctl status`, `cellctl robot`. To ask the devices themselves, "
    remedy += "end it while the arms stand and check again: a service by `systemctl stop cellctl`, "
    remedy += "a program in a terminal by Ctrl-C there. `make cell` takes its fake devices along; "
    remedy += "`python -m fakes run --scenario FILE` starts them without a daemon."


class OtherDevice(LocalError):
    """What answers is not what the cell file or a calibration says."""

    number = 741
    text = "A device is not the one that is meant"
    cause = "Exchanged devices or cables, a value of another cell in the file, or a calibration "
    cause += "that was made with another device."
    remedy = "Correct the cell file, or connect the device that it means. A calibration of another "
    remedy += "device is made anew."
