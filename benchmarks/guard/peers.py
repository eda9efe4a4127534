"""The outside world of the guard benchmark: box and robot, each a process that only stamps.

The box is the fake box's own session on a plain blocking socket, so that nothing but the frame lies
between the stamp and the wire. While the force is on, every frame carries 30 N.
"""

import random
import select
import socket
import time
from multiprocessing.connection import Connection, wait

import numpy as np

from cellctl.guard.watch import realtime
from fakes.wire.sri.core import SriCore
from fakes.wire.sri.session import SriSession

FORCE_N = 30.0
PRIORITY = 90
_HELLO = "HELLO,SJL,1,GRD,SR500A,1.0,EUL=ZYX,UNIT=MMDEG,STEPMAX=0.5000,DEADMAN=300"
_POSE = "1900.0000,-0.1250,927.0000,90.0000,0.0000,180.0000"
_JOINTS = "0.00000,-45.00000,90.00000,0.00000,45.00000,0.00000"


def box(pipe: Connection) -> None:
    """Tell the port, serve one client; then ``on``, ``off``, and the stamps of forced frames."""
    force = [0.0] * 6
    session = SriSession(SriCore(lambda _: [value + random.gauss(0, 0.2) for value in force]))
    stamps: list[float] = []
    with socket.create_server(("127.0.0.1", 0)) as listener:
        pipe.send(listener.getsockname()[1])
        client, _ = listener.accept()
    client.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    realtime.enter(PRIORITY, None, lock_memory=True)
    with client:
        while True:
            due_s = session.due_s
            wait_s = 0.1 if due_s is None else max(0.0, due_s - time.monotonic())
            ready = wait([client, pipe], wait_s)
            if pipe in ready:
                word = pipe.recv()
                if word == "end":
                    break
                force[2] = FORCE_N if word == "on" else 0.0
            if client in ready:
                data = client.recv(4096)
                if not data:
                    raise ConnectionError("the design under test has gone")
                if replies := session.receive(data, time.monotonic()):
                    client.sendall(replies)
            # A real box has no backlog: what could not be sent in time is left out, not sent late.
            for frame in session.emit(time.monotonic())[-1:]:
                if force[2]:
                    stamps.append(time.monotonic())
                client.sendall(frame)
    pipe.send(np.array(stamps))


def robot(pipe: Connection, port: int) -> None:
    """Connect as the job program on GRD; the stamps of the stop requests."""
    link = _greeted(port)
    realtime.enter(PRIORITY, None, lock_memory=True)
    stamps: list[float] = []
    tail, count, report_s = b"", 0, time.monotonic()
    with link:
        while True:
            wait_s = max(0.0, report_s - time.monotonic())
            ready = wait([link, pipe], wait_s)
            if link in ready:
                data = link.recv(4096)
                now_s = time.monotonic()
                *lines, tail = (tail + data).split(b"\n")
                stamps += [now_s] * sum(line.startswith(b"ABORT") for line in lines)
                if not data:
                    break
            if pipe in ready:
                break
            if time.monotonic() >= report_s:
                report_s += 0.02
                count += 1
                link.sendall(
                    _line(f"STAT,{count},{count * 20},REM,0,1,0,1,0,100,{_POSE},{_JOINTS}")
                )
    pipe.send(np.array(stamps))


def _greeted(port: int) -> socket.socket:
    """Try until the design under test listens and has said yes; a stranger may hold the port."""
    give_up_s = time.monotonic() + 20.0
    while time.monotonic() < give_up_s:
        link = socket.socket()
        link.settimeout(2.0)
        try:
            link.connect(("127.0.0.1", port))
            link.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            link.sendall(_line(_HELLO))
            if link.recv(256).startswith(b"OK,HELLO"):
                return link
        except (ConnectionError, TimeoutError):
            select.select([], [], [], 0.02)
        link.close()
    raise TimeoutError(f"nobody on port {port} speaks SJL")


def _line(body: str) -> bytes:
    return f"{body}*{sum(body.encode()) % 256:02X}\n".encode()
