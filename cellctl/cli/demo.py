"""`cellctl demo`: the main job on the fake cell, which is a program of its own."""

import os
import sys

import typer

PASS_THROUGH = {"allow_extra_args": True, "ignore_unknown_options": True, "help_option_names": []}


def demo(context: typer.Context) -> None:
    """Start fake cell, daemon and line PLC and assemble one deck (`--help` for its options).

    That program takes the place of this one: a signal must reach it and nobody else.
    """
    os.execv(sys.executable, [sys.executable, "-m", "fakes", "demo", *context.args])
