"""The guard process: ``python -m cellctl.guard.watch.main LINK MEMORY``.

The arguments are the numbers of two inherited descriptors: the socket to the daemon and the shared
memory of the ring. ``cellctl.guard.child`` starts the process and sends the set-up as the first
message. The drivers that it names are loaded at once, and opened at the second message, which may
come much later. The process ends when the daemon ends, and stops the robot then.
"""

import os
import signal
import socket
import sys

from cellctl import plugins
from cellctl.errors.base import CellError
from cellctl.errors.internal import Unexpected
from cellctl.guard.messages import OPEN, Message, encode, fault_to_json, receive
from cellctl.guard.ring import RingWriter
from cellctl.guard.watch import realtime
from cellctl.guard.watch.loop import GuardLoop
from cellctl.guard.watch.monitor import WrenchMonitor
from cellctl.guard.watch.stop_supervisor import StopSupervisor
from cellctl.interfaces.ft_sensor import FtSensor
from cellctl.interfaces.stop_channel import StopChannel
from cellctl.parent_death import die_with_parent


def main(loop_type: type[GuardLoop] = GuardLoop) -> int:
    """Run the guard and return its exit code: 0 after an end that was asked for, else 1.

    ``loop_type`` lets a benchmark run the same process with a loop that goes on after each trip.
    """
    # In case the end of the link to the daemon is missed.
    die_with_parent(signal.SIGTERM)
    # Ctrl-C in a terminal reaches every process of its group. The daemon handles it and then ends
    # the guard; a guard that ended first would look like a crash.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    link = socket.socket(fileno=int(sys.argv[1]))
    set_up = receive(link)
    if set_up is None:
        return 1
    try:
        run(link, int(sys.argv[2]), set_up, loop_type)
    except CellError as fault:
        _report(link, fault)
        return 1
    except Exception as error:
        _report(link, Unexpected(f"in the guard: {error!r}"))
        raise
    return 0


def run(
    link: socket.socket, memory: int, set_up: Message, loop_type: type[GuardLoop] = GuardLoop
) -> None:
    """Load the drivers; once told, open the sensor, begin with the stop channel and guard.

    Raises what the sensor's driver raises when the sensor cannot be opened.
    """
    sensor: FtSensor = _load(plugins.FT_SENSOR, set_up["sensor"])
    channel: StopChannel | None = None
    if set_up["stop_channel"] is not None:
        channel = _load(plugins.STOP_CHANNEL, set_up["stop_channel"])
    supervisor = StopSupervisor(channel, set_up["stop_confirm_s"])
    monitor = WrenchMonitor(tuple(set_up["flange_R_sensor"]), has_channel=channel is not None)
    ring = RingWriter(memory)
    if not _told_to_open(link):
        return
    # Only now, after what may be waited for. From here on a socket that blocks would hold up the
    # judgement of samples.
    link.settimeout(0.0)
    with sensor:
        loop = loop_type(sensor, supervisor, monitor, ring=ring, link=link, beat_s=set_up["beat_s"])
        signal.signal(signal.SIGTERM, lambda *_: setattr(loop, "ended", True))
        # A robot may take seconds to accept the connection, so a thread begins with that now.
        supervisor.open()
        # Everything is allocated and loaded by this moment: locked memory then needs no further
        # page from the disk, and starting up does not run before ordinary processes.
        degraded = realtime.enter(
            set_up["fifo_priority"], set_up["cpu"], lock_memory=set_up["lock_memory"]
        )
        serial = sensor.serial_number()
        loop.event("ready", serial=serial, degraded=degraded, has_channel=channel is not None)
        try:
            loop.run()
        finally:
            supervisor.close()


def _told_to_open(link: socket.socket) -> bool:
    """Wait for the daemon's word; False where it ends before it has a use for this guard."""
    message = receive(link)
    return message is not None and message["do"] == OPEN["do"]


def _load(group: str, what: Message):  # type: ignore[no-untyped-def]
    """A driver by its plug-in name, made from its own section of the cell file."""
    driver = plugins.load(group, what["name"])
    return driver(driver.Config.model_validate(what["config"]))  # type: ignore[attr-defined]


def _report(link: socket.socket, fault: CellError) -> None:
    """Tell the daemon why the guard ends, if it still listens."""
    try:
        link.send(encode({"event": "failed", **fault_to_json(fault)}))
    except OSError as error:
        print(f"guard: {fault} (not delivered: {error})", file=sys.stderr)


if __name__ == "__main__":
    code = main()
    sys.stderr.flush()
    # An ordinary exit joins threads, and one may still wait for a robot that never connects.
    os._exit(code)
