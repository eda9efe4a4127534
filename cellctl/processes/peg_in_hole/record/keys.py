"""Names that the record of an insertion uses; a report finds its figures by them.

They never change: stores keep runs for years, and evaluation compares runs of all of them.
"""

FACE, INSERTION, LOOP = "face", "insertion", "loop"
"""Streams; their ticks are files of these names."""
FACE_HEIGHT, FACE_TILT = "face.height", "face.tilt"
PANEL_SHIFT, PANEL_TURN = "panel.shift", "panel.turn"
"""Shift and turn of the face from its reference."""
CHOICE, CYCLE, TRACE, MAP = "search.choice", "insertion.result", "search.trace", "search.map"
FAILURE = "insertion.failure"
TASK = "insertion.task"
"""What `cellctl judge-insertion` needs beside the ticks."""
SEARCH_TIME, TOUCHES = "search.time", "search.touches"
PEAK = "insertion.greatest_force"


def ticks(stream: str) -> str:
    """Name of the file with the ticks of a stream."""
    return f"{stream}.csv"


def check(name: str) -> str:
    """Key of an item of the verdict."""
    return "verdict." + name.replace(" ", "_")
