"""Where every procedure begins: nothing stands in the way of what it will move."""

from cellctl.cell.gather import together
from cellctl.cell.stereo_station import HeadStation
from cellctl.procedures.context import ProcedureContext
from cellctl.processes.deck_to_frame.taught_poses import (
    head_to_measuring_pose,
    head_to_retracted_pose,
    main_to_home,
)


async def clear_the_cell(
    context: ProcedureContext, *, measuring: HeadStation | None = None
) -> None:
    """Main robot home, then the heads retracted; ``measuring`` goes to its measuring pose instead.

    One after the other: home is clear of the heads wherever these stand, and no head swings past
    a main robot that is under way. Raises what the robots raise.
    """
    context.board.update(message="to the beginning")
    await main_to_home(context.cell)
    others = [head for head in context.cell.heads if head is not measuring]
    await together(*(head_to_retracted_pose(head) for head in others))
    if measuring is not None:
        await head_to_measuring_pose(measuring)
