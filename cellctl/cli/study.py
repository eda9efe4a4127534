"""`cellctl study`: many seeds of a trial, by a program of its own that no daemon loads."""

import os
import sys

import typer

from cellctl.errors.config import StudyUnavailable
from cellctl.version import ROOT


def study(context: typer.Context) -> None:
    """Run a trial of a recipe over thousands of seeds on Dask (`--help` for more).

    That program takes the place of this one: Ctrl-C must reach it and nobody else.
    """
    # By name and as another program, because the core must not import the fakes. The trials need
    # the whole checkout, which a plain package does not bring.
    if not (ROOT / "benchmarks" / "study").is_dir():
        raise StudyUnavailable(f"there is no {ROOT / 'benchmarks'}")
    environment = os.environ | {
        "STUDY_NAME": "cellctl study",
        "PYTHONPATH": os.pathsep.join(filter(None, (str(ROOT), os.environ.get("PYTHONPATH")))),
        # Each worker has one processor.
        "OPENBLAS_NUM_THREADS": "1",
    }
    program = [sys.executable, "-P", "-m", "benchmarks.study", *context.args]
    os.execve(sys.executable, program, environment)
