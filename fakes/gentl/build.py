"""Compiles the fake GenTL producer with the compiler of the system.

`python -m fakes.gentl.build FOLDER` does the same.
"""

import shutil
import subprocess
import sys
from pathlib import Path

SOURCES = Path(__file__).parent / "producer"
NAME = "fake_gentl.cti"
_FLAGS = ("-std=gnu11", "-O2", "-Wall", "-Wextra", "-Werror", "-fvisibility=hidden", "-fPIC")
_DESCRIPTIONS = ("camera_xml", "interface_xml", "module_xml")


class NoCompilerError(RuntimeError):
    """There is no C compiler on this machine, or it refuses the producer."""


def build_producer(folder: Path, *options: str, **descriptions: Path) -> Path:
    """Compile into a folder; the path of the producer. ``options`` are the compiler's.

    ``camera_xml``, ``interface_xml`` and ``module_xml`` are other descriptions than those beside
    the sources. Raises ``NoCompilerError``.
    """
    compiler = shutil.which("cc")
    if compiler is None:
        raise NoCompilerError("no C compiler (cc) on this machine")
    target = folder / NAME
    texts = {
        name: SOURCES / f"{name.removesuffix('_xml')}.xml" for name in _DESCRIPTIONS
    } | descriptions
    defined = [f'-D{name.upper()}="{path}"' for name, path in texts.items()]
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


if __name__ == "__main__":
    print(build_producer(Path(sys.argv[1])))
