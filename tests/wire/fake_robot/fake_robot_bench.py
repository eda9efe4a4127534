"""A fake controller with open channels on a bench, its clock moved by hand."""

from pathlib import Path

from fakes.faults import ROBOT_FAULTS, FaultBoard
from fakes.scenario_file.scenario import Scenario
from fakes.scenario_file.sections import Channel
from fakes.scenes.load import load
from fakes.wire.sjl.logic import Controller, Outbox, Record
from fakes.world.robot import RobotArm
from fakes.world.truth import draw
from tests.rigs.wire.scenarios import as_on_a_real_cell

HOME = "0,-90,90,0,90,90"
WORK = "0,-52.766,109.14,0,33.626,90"
SCENARIO = as_on_a_real_cell(load(Path(__file__).parents[3] / "config" / "deck.scenario.toml"))


class Bench:
    """A controller with its channels open, a PC that beats, and a clock that is moved by hand."""

    def __init__(self, scenario: Scenario = SCENARIO) -> None:
        robot = scenario.robots["main"]
        self.faults = FaultBoard("main", ROBOT_FAULTS)
        arm = RobotArm(robot, draw(scenario, 1).robots["main"], 1)
        self.controller = Controller(arm, self.faults)
        self.time_s = 0.0
        self.beating: set[Channel] = {"STA"}
        self.seq = 0
        self.controller.opened("CMD", 11, 0.0)
        self.controller.opened("STA", 12, 0.0)

    def send(
        self, word: str, values: str = "", *, seq: int | None = None, session: int = 11
    ) -> list[Record]:
        if seq is None:
            self.seq += 1
            seq = self.seq
        fields = [word, str(session), str(seq), *(values.split(",") if values else [])]
        return [record for _, record in self.controller.command(fields, self.time_s)]

    def abort(self, channel: Channel = "STA", number: int = 1) -> None:
        session = self.controller.links[channel].session
        self.controller.supervise(channel, ["ABORT", str(session), str(number)], self.time_s)

    def run(self, seconds: float) -> Outbox:
        out: Outbox = []
        until_s = self.time_s + seconds
        while self.time_s < until_s:
            self.time_s += 0.004
            for channel in self.beating & set(self.controller.links):
                session = self.controller.links[channel].session
                self.controller.supervise(channel, ["BEAT", str(session), "1"], self.time_s)
            out += self.controller.tick(self.time_s)
        return out

    def pose(self, z_mm: float) -> str:
        x, y, z = self.controller.arm.encoder_pose(self.time_s).translation * 1000
        return f"{x:.4f},{y:.4f},{z + z_mm:.4f},90,0,180"


def at_work() -> Bench:
    """A bench whose arm stands over the frame."""
    bench = Bench()
    assert bench.send("MOVJ", f"{WORK},100") == [["ACK", "1"]]
    (channel, done), *_ = bench.run(5.0)
    assert (channel, done[:2]) == ("CMD", ["DONE", "1"])
    return bench


def words(out: Outbox) -> list[tuple[str, ...]]:
    return [(channel, *record[:3]) for channel, record in out]
