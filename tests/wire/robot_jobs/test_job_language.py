"""The interpreter of job files: what the language allows, and what a statement does."""

import asyncio
import re
from pathlib import Path

import pytest

from fakes.faults import JOB_FAULTS, FaultBoard
from fakes.robot_jobs.lexer import JobError
from fakes.robot_jobs.memory import Memory
from fakes.robot_jobs.motion import Motions
from fakes.robot_jobs.program import load_program
from fakes.robot_jobs.strings import WORDS
from fakes.robot_jobs.task import Shared, Task
from fakes.scenes.load import load
from fakes.wire.sjl.panel import Panel
from fakes.world.robot import RobotArm
from fakes.world.truth import draw
from tests.rigs.wire.job_rig import JOBS
from tests.rigs.wire.standing_arm import SCENARIO


def job(folder: Path, *lines: str) -> Path:
    path = folder / "TRY.job"
    path.write_text("\n".join(["NOP", *lines, "END"]) + "\n", "ascii")
    return path


def still_arm() -> Motions:
    scenario = load(SCENARIO)
    arm = RobotArm(scenario.robots["main"], draw(scenario, seed=1).robots["main"], seed=1)
    board = FaultBoard("robot", JOB_FAULTS)
    return Motions(arm, lambda: arm.standstill_s, lambda: Panel(board, arm.by_hand))


def run(folder: Path, *lines: str) -> Memory:
    memory = Memory(lambda family, index: 1)
    shared = Shared(
        memory=memory,
        motions=still_arm(),
        clock=lambda: 0.0,
        timer=lambda: 0.0,
        route=lambda host, port: (host, port),
        socket=lambda: None,  # type: ignore[arg-type, return-value]
        start=lambda name: None,
        frozen=lambda: False,
        statement_s=0.0,
    )
    asyncio.run(Task(load_program(job(folder, *lines)), shared, background=False).run())
    return memory


@pytest.mark.parametrize(
    "line",
    [
        "MOVE P[1]",
        "MOVL P[1] V = 5 ACC = R[1] FINE",
        "R[1] = R[2] + R[3] * 2",
        "I[1] = P[1].J1 * 100000",
        "R[1] = R[2] - PR[3].J6",
        "P[1].J1 = R[1]",
        "P[1].X = ABS R[1]",
        "I[1] = SQRT R[1]",
        "STR2R S[1] H[1]",
        "IN H[1] = GIB[1]",
        "SET R[1] 007",
        "SETP P[1] FRAME XF 0",
        "SETP P[1] FRAME UF R[1]",
        "S[1] = R[1]",
        "SET S[1] S[2] S[3]",
        "STRSUB S[1] 0 4 S[2]",
        'IF I[1] = 2 : GOTO "A"',
        "IF I[1] == 2 AND I[2] == 2 OR I[3] == 2",
        "IF I[1] == 2 : SET I[1] 3",
        'GOTO "NOWHERE"',
        'TCPCREATE "X" SERVERIP = "host" PORT = 1',
        "ELSE",
        "//without a blank",
    ],
)
def test_a_line_that_the_grammar_does_not_allow_is_refused(tmp_path: Path, line: str) -> None:
    with pytest.raises(JobError, match=r"TRY"):
        load_program(job(tmp_path, line))


def test_numbers_strings_and_jumps(tmp_path: Path) -> None:
    memory = run(
        tmp_path,
        "SET I[1] 4",
        "SET I[2] 7",
        'SET S[1] "BEAT1000017;AB"',
        "STRSUB S[1] I[1] I[2] S[2]",
        "STR2I S[2] I[3]",
        "I[3] = I[3] - 1000000",
        'SET S[3] ";"',
        "STRFINDEND S[1] S[3] I[4]",
        "R[1] = I[3] / 4",
        "R[2] = 2 - 5",
        "R[2] = ABS R[2]",
        "I[5] = -7 / 2",
        "IF I[3] == 17 AND R[1] > 4.2",
        "SET I[6] 1",
        "ELSE",
        "SET I[6] 2",
        "ENDIF",
        'IF I[6] == 1 : GOTO "END"',
        "SET I[7] 1",
        'LABEL "END"',
        "IF DI[3] == 1 : OUT DO[9] 1",
    )
    found = [memory.numbers["I", index] for index in range(3, 8)]
    assert found == [17, 11, -3, 1, 0]
    assert (memory.numbers["R", 1], memory.numbers["R", 2]) == (4.25, 3.0)
    assert memory.outputs["DO", 9] == 1


@pytest.mark.parametrize(
    "lines",
    [
        ('SET S[1] "1.5.2"', "STR2R S[1] R[1]"),
        ("SET R[1] 3000000000", "SET I[1] R[1]"),
        ("UALM CODE = 7",),
        ("R[1] = P[1].X + 1",),
        ("P[1].X = 1900",),
        ("SETP P[1] FRAME UF 0",),
        ("GETP P[1]", "SETP P[1] FRAME UF 3"),
        ("GETP P[1]", "SET P[1].J1 30", "P[1].X = 1900"),
        ("GETP P[1]", "P[1].X = 1900", "SET R[1] P[1].J1"),
        ("GETP P[1]", "P[1].X = 1900", "MOVJ P[1] V = 10 ACC = 100 FINE"),
        ("GETP P[1]", "SET P[1].J1 30", "MOVL P[1] V = 10 ACC = 100 FINE"),
        ("MOVJ PR[1] V = 10 ACC = 100 FINE",),
        (f'SET S[1] "{"A" * 100}"', "S[1] = S[1] + S[1]"),
    ],
)
def test_what_a_controller_would_stop_with_an_alarm(tmp_path: Path, lines: tuple[str, ...]) -> None:
    with pytest.raises(JobError, match=r"TRY, line \d"):
        run(tmp_path, *lines)


def test_a_position_of_where_the_arm_is_has_pose_and_joints(tmp_path: Path) -> None:
    memory = run(
        tmp_path,
        "GETP P[1]",
        "SETP P[1] FRAME TF 0",
        "R[1] = P[1].X - P[1].X",
        "SET R[2] P[1].J2",
        "R[2] = ABS P[1].J2",
        "IF P[1].J2 == P[1].J2 : OUT DO[1] 1",
        "SET PR[2] P[1]",
        "SET PR[2].J1 30",
        "SET R[3] PR[2].J1",
        "R[4] = P[1].RZ - 0",
    )
    assert (memory.numbers["R", 1], memory.numbers["R", 3]) == (0.0, 30.0)
    assert memory.outputs["DO", 1] == 1


def test_the_two_background_jobs_differ_in_their_places_only() -> None:
    def without_places(name: str) -> list[str]:
        lines = (JOBS / f"{name}.job").read_text("ascii").splitlines()
        own = [line for line in lines if not line.startswith(("// ", "! "))]
        masked = [re.sub(r"\[\d+\]|INDEX = \d|PORT = \d+|STA\b|GRD\b", "#", line) for line in own]
        # The guard's contact is closed until a guard has come for the first time.
        return [line for line in masked if not line.startswith("OUT DO#")]

    assert without_places("SJLSTA") == without_places("SJLGRD")


def test_the_jobs_write_what_is_theirs_alone() -> None:
    """Tasks of the language have no locks: every shared variable has one writer."""
    writers: dict[str, set[str]] = {}
    for path in JOBS.glob("*.job"):
        for statement in load_program(path).statements:
            for one in (statement, statement.then):
                if one is None or not one.tokens:
                    continue
                written = {"=": 0, "SET": 0, "IN": 0, "OUT": 0}.get(one.word)
                if written is None and one.word in WORDS:
                    written = -1
                if one.word in {"TIMER", "TCPRECV"}:
                    written = -1
                if written is not None and not one.tokens[written].text.startswith(("P[", "T")):
                    writers.setdefault(one.tokens[written].text, set()).add(path.stem)
                if one.word == "TCPRECV":
                    writers.setdefault(one.tokens[1].text, set()).add(path.stem)
    shared = {name: jobs for name, jobs in writers.items() if len(jobs) > 1}
    assert shared == {}
