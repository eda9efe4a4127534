"""Step 20: measure how the gripper holds the deck (paper 2.1.3, eq. 4)."""

from cellctl.cell.guarded_motion.settling import settle
from cellctl.geometry.pose import pose_from_xyzabc
from cellctl.geometry.uncertain import UncertainPose
from cellctl.processes.deck_to_frame.moves.taught_poses import main_to_pose
from cellctl.processes.deck_to_frame.poses.deck_on_flange import deck_on_flange
from cellctl.processes.deck_to_frame.poses.pose_limits import require_near
from cellctl.processes.deck_to_frame.roles import DECK_MEASURE
from cellctl.processes.deck_to_frame.state import DeckMeasured, FrameMeasured


async def measure_deck(frame: FrameMeasured) -> DeckMeasured:
    """Bring the deck above the station, measure it, and solve its pose on the flange."""
    run = frame.run
    main = run.cell.main
    await main_to_pose(run.cell, DECK_MEASURE)
    await settle(run.cell.guard)
    nominal = pose_from_xyzabc(run.recipe.flange_T_deck)
    # From where the robot says it is, because a joint move ends only within its tolerance.
    predicted = run.base_T_c1.inv() * main.state().base_T_flange * nominal
    measurement = await run.measure(run.facts.deck_features, predicted)
    flange_T_deck = deck_on_flange(
        UncertainPose.exact(measurement.base_T_flange),
        run.facts.geometry.base_T_c1,
        measurement.pose.pose,
    )
    require_near("deck on flange", run.recipe, nominal, flange_T_deck.pose)
    await run.recorder.measurement("deck", measurement)
    await run.recorder.deck_on_flange(flange_T_deck)
    return DeckMeasured(run, frame.frame, flange_T_deck=flange_T_deck.pose)
