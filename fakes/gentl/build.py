"""Compiles the fake GenTL producer with the compiler of the system."""

import shutil
import subprocess
from pathlib import Path

SOURCES = Path(__file__).parent / "producer"
NAME = "fake_gentl.cti"
_FLAGS = ("-std=gnu11", "-O2", "-Wall", "-Wextra", "-Werror", "-fvisibility=hidden", "-fPIC")


class NoCompilerError(RuntimeError):
    """There is no C compiler on this machine, or it refuses the producer."""


def build_producer(folder: Path, *options: str, camera_xml: Path | None = None) -> Path:
    """Compile into a folder; the path of the producer. ``options`` are the compiler's.

    ``camera_xml`` is the description of another camera than that of ``producer/camera.xml``.
    Raises ``NoCompilerError``.
    """
    compiler = shutil.which("cc")
    if compiler is None:
        raise NoCompilerError("no C compiler (cc) on this machine")
    target = folder / NAME
    texts = {name: SOURCES / f"{name.lower()}.xml" for name in ("CAMERA", "MODULE")}
    texts["CAMERA"] = camera_xml or texts["CAMERA"]
    defined = [f'-D{name}_XML="{path}"' for name, path in texts.items()]
    command = [compiler, *_FLAGS, *options, *defined, "-shared", "-pthread", "-o", str(target)]
    built = subprocess.run(
        [*command, *map(str, sorted(SOURCES.glob("*.c")))],
        capture_output=True,
        text=True,
        check=False,
    )
    if built.returncode:
        raise NoCompilerError(built.stderr)
    return target
