"""``python -m benchmarks.samples``: writes all sample files."""

from pathlib import Path
from typing import Annotated

import typer

from benchmarks.samples import images, plugging, poses


def write(out: Annotated[Path, typer.Option(help="Folder, made where it is missing.")]) -> None:
    """Write the sample files; those of the same name are replaced."""
    images.write_board(out / "board")
    images.write_plate(out / "plate")
    images.write_connector(out / "connector")
    poses.write_hand_eye(out / "hand-eye.json")
    poses.write_base_frame(out / "base-frame.json")
    poses.write_transfer(out / "transfer.json")
    poses.write_tool(out / "tool.json")
    poses.write_payload(out / "payload.csv")
    plugging.write_plugging(out / "plugging")


if __name__ == "__main__":
    typer.run(write)
