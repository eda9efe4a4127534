"""The process of the maker's library ends with its cameras let go."""

import ctypes
import os
import signal
from contextlib import suppress
from multiprocessing import Pipe
from typing import Any
from unittest.mock import Mock

import pytest

from drivers.camera.gige.library_process import child


@pytest.mark.parametrize("error", [EOFError("gone"), RuntimeError("of the maker's library")])
def test_cameras_are_let_go_whatever_ends_it(
    error: Exception, monkeypatch: pytest.MonkeyPatch
) -> None:
    """One that is kept is busy for whoever opens it next."""
    # This process is not its own child: neither its signals nor its end are changed.
    monkeypatch.setattr(signal, "signal", Mock())
    monkeypatch.setattr(ctypes, "CDLL", Mock())
    cameras: Any = Mock(answer=Mock(side_effect=error))
    monkeypatch.setattr(child, "_Cameras", lambda: cameras)
    ours, theirs = Pipe()
    with ours, theirs:
        ours.send("grab")
        with suppress(RuntimeError):
            child.serve(theirs, os.getppid())
    cameras.close.assert_called_once_with()
