"""Clears the way for a procedure: every procedure begins with this."""

from cellctl.cell.gather import gather_or_cancel
from cellctl.cell.stereo_station import StereoStation
from cellctl.processes.deck_to_frame.moves.taught_poses import (
    head_to_measuring_pose,
    head_to_retracted_pose,
    main_to_home,
)
from cellctl.processes.deck_to_frame.stations import DeckCell
from cellctl.runtime.progress import ProgressBoard


async def clear_the_cell(
    cell: DeckCell, board: ProgressBoard, *, measuring: StereoStation | None = None
) -> None:
    """Main robot home, then the heads retracted; ``measuring`` goes to its measuring pose instead.

    One after the other: home is clear of the heads wherever these stand, and no head swings past
    a main robot that is under way. Raises what the robots raise.
    """
    board.update(message="to the beginning")
    await main_to_home(cell)
    others = [head for head in cell.heads if head is not measuring]
    await gather_or_cancel(*(head_to_retracted_pose(head) for head in others))
    if measuring is not None:
        await head_to_measuring_pose(measuring)
