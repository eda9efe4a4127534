"""`cellctl demo`: the main job on the fake cell, which is a program of its own."""

import subprocess
import sys

import typer

PASS_THROUGH = {"allow_extra_args": True, "ignore_unknown_options": True}


def demo(context: typer.Context) -> None:
    """Start fake cell, daemon and line PLC and assemble one deck (`--help` for its options)."""
    command = [sys.executable, "-m", "fakes", "demo", *context.args]
    try:
        code = subprocess.run(command, check=False).returncode
    except KeyboardInterrupt:
        code = 130
    raise typer.Exit(code)
