"""The guard process: ``python -m cellctl.guard.process LINK MEMORY``, two inherited descriptors.

It is started by ``cellctl.guard.client``, which sends the set-up as the first message. It ends when
the daemon ends, and stops the robot then.
"""

import os
import signal
import socket
import sys

from cellctl import plugins
from cellctl.errors.base import CellError
from cellctl.errors.internal import Unexpected
from cellctl.guard import realtime
from cellctl.guard.loop import GuardLoop
from cellctl.guard.messages import Message, encode, fault_to_json, receive
from cellctl.guard.monitor import Monitor
from cellctl.guard.ring import RingWriter
from cellctl.guard.stop_line import StopLine
from cellctl.interfaces.ft_sensor import FtSensor
from cellctl.interfaces.stop_channel import StopChannel


def main(loop_type: type[GuardLoop] = GuardLoop) -> int:
    """Run the guard; the exit code is 0 for an end that was asked for.

    A benchmark may bring a loop that goes on after each trip.
    """
    realtime.die_with_parent()
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
    """Open the sensor, begin to open the stop channel, and guard."""
    sensor: FtSensor = _load(plugins.FT_SENSOR, set_up["sensor"])
    channel: StopChannel | None = None
    if set_up["stop_channel"] is not None:
        channel = _load(plugins.STOP_CHANNEL, set_up["stop_channel"])
    line = StopLine(channel, set_up["stop_confirm_s"])
    monitor = Monitor(tuple(set_up["flange_R_sensor"]), has_channel=channel is not None)
    ring = RingWriter(memory)
    link.settimeout(0.0)
    with sensor:
        loop = loop_type(sensor, line, monitor, ring=ring, link=link, beat_s=set_up["beat_s"])
        signal.signal(signal.SIGTERM, lambda *_: setattr(loop, "ended", True))
        line.open()
        degraded = realtime.settle(
            set_up["fifo_priority"], set_up["cpu"], lock_memory=set_up["lock_memory"]
        )
        serial = sensor.serial_number()
        loop.event("ready", serial=serial, degraded=degraded, channel=channel is None)
        try:
            loop.run()
        finally:
            line.close()


def _load(group: str, what: Message):  # type: ignore[no-untyped-def]
    """A driver by name, made from its own section of the cell file."""
    driver = plugins.load(group, what["name"])
    return driver(driver.Config.model_validate(what["config"]))  # type: ignore[attr-defined]


def _report(link: socket.socket, fault: CellError) -> None:
    """Last words, if anybody listens."""
    try:
        link.send(encode({"event": "failed", **fault_to_json(fault)}))
    except OSError as error:
        print(f"guard: {fault} (not delivered: {error})", file=sys.stderr)


if __name__ == "__main__":
    code = main()
    sys.stderr.flush()
    os._exit(code)  # a thread that still waits for the robot must not delay the end
