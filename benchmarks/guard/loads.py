"""What else runs on the machine while the guard is measured."""

import json
import os
import tempfile
import threading
import time
from collections.abc import Callable

import cv2
import numpy as np

IMAGE = (2048, 2448)
BOMB_PERIOD_S = 2.0
EVENT_PERIOD_S = 5e-3

Stop = Callable[[], bool]


def vision(stop: Stop) -> None:
    """Filter, edges, contours and ellipses on 5 MP images without a pause; an event for each."""
    cv2.setNumThreads(1)
    rng = np.random.default_rng(1)
    image = rng.integers(90, 110, IMAGE, dtype=np.uint8)
    for x, y in rng.integers(200, 1800, (40, 2)):
        cv2.circle(image, (int(x), int(y)), 60, 30, -1, cv2.LINE_AA)
    while not stop():
        blurred = cv2.GaussianBlur(image, (9, 9), 0)
        edges = cv2.Canny(blurred, 40, 120)
        contours, _ = cv2.findContours(edges, cv2.RETR_LIST, cv2.CHAIN_APPROX_NONE)
        fits = [cv2.fitEllipse(contour) for contour in contours if len(contour) > 100]
        json.dumps([[*centre, *axes, angle] for centre, axes, angle in fits])


def events(stop: Stop) -> None:
    """Two hundred log lines a second to a file, on the disk once a second."""
    with tempfile.TemporaryFile("w") as file:
        synced_s = time.monotonic()
        number = 0
        while not stop():
            number += 1
            fields = {"event": "sample", "number": number, "time": time.time(), "state": "execute"}
            file.write(json.dumps(fields) + "\n")
            if time.monotonic() - synced_s > 1.0:
                synced_s = time.monotonic()
                file.flush()
                os.fdatasync(file.fileno())
            time.sleep(EVENT_PERIOD_S)


def bomb(stop: Stop) -> None:
    """One call that keeps the interpreter lock for tens of milliseconds: a run of 20 s as JSON."""
    run = np.random.default_rng(2).normal(size=(20_000, 7)).tolist()
    while not stop():
        json.dumps(run)
        time.sleep(BOMB_PERIOD_S)


def bomb_ms() -> float:
    """How long that call takes here."""
    run = np.random.default_rng(2).normal(size=(20_000, 7)).tolist()
    begin_s = time.perf_counter()
    json.dumps(run)
    return (time.perf_counter() - begin_s) * 1e3


def threads(names: list[Callable[[Stop], None]], stop: threading.Event) -> list[threading.Thread]:
    """Run loads in threads of this process."""
    started = [threading.Thread(target=load, args=(stop.is_set,), daemon=True) for load in names]
    for thread in started:
        thread.start()
    return started
