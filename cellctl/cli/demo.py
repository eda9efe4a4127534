"""`cellctl demo`: one job of a process on its fake cell, which is a program of its own."""

import os
import sys

import typer

PASS_THROUGH = {"allow_extra_args": True, "ignore_unknown_options": True, "help_option_names": []}


def demo(context: typer.Context) -> None:
    """Start a fake cell, daemon and line PLC and run one job (`--process`; `--help` for more).

    That program takes the place of this one: a signal must reach it and nobody else.
    """
    # By name and as another program, because the core must not import the fakes.
    environment = os.environ | {"FAKES_DEMO_NAME": "cellctl demo"}
    # Not from the folder in which one stands (-P): beside a clone lies a folder called cellctl.
    program = [sys.executable, "-P", "-m", "fakes", "demo", *context.args]
    os.execve(sys.executable, program, environment)
