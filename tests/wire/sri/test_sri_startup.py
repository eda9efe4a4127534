"""The start-up's own words, against a box that is a script: literal commands, literal answers."""

from collections.abc import Mapping

import pytest

from cellctl.errors.force import SensorSetupWrong
from cellctl.errors.link import ReplyTimeout
from drivers.ftsensor.sri.config import SriConfig
from drivers.ftsensor.sri.protocol import Reply
from drivers.ftsensor.sri.startup import AtCommandStartUp, CanStartUp

MATRIX = ";".join("(" + ",".join(str(float(i == j)) for j in range(6)) + ")" for i in range(6))
FORMAT = "(A01,A02,A03,A04,A05,A06);{unit};1;(WMA:1.000000)"
ANSWERS = {
    "GSD=STOP": "STOP",
    "SFWV=?": "V1.3",
    "DCPCU=?": "MVPV",
    "DCPM=?": MATRIX,
    "DCKMD=SUM": "SUM",
    "SGDM=?": FORMAT.format(unit="E"),
    "SGDM=(A01,A02,A03,A04,A05,A06);E;1;(WMA:1)": FORMAT.format(unit="E"),
    "SMPF=1000": "1000.0",
}


def talk(answers: Mapping[str, str | None], **settings: object) -> list[str]:
    """What the driver says when a key missing here is an error and None is silence."""
    config = SriConfig.model_validate({"transport": "tcp", **settings})
    start_up = AtCommandStartUp(config).run()
    said: list[str] = []
    reply: Reply | None = None
    try:
        while True:
            exchange = start_up.send(reply)
            text = exchange.send.decode().strip().removeprefix("AT+")
            said.append(text)
            value = answers.get(text, "")
            ok = text in answers
            reply = None if value is None else Reply(exchange.name, value, ok)
    except StopIteration:
        return said


def test_the_order() -> None:
    assert talk(ANSWERS) == [
        "GSD=STOP",
        "SFWV=?",
        "DCPCU=?",
        "DCPM=?",
        "DCKMD=SUM",
        "SGDM=(A01,A02,A03,A04,A05,A06);E;1;(WMA:1)",
        "SGDM=?",
        "SMPF=1000",
        "GSD",
    ]


def test_smpr_after_an_error_and_after_silence() -> None:
    older = {key: value for key, value in ANSWERS.items() if key != "SMPF=1000"}
    older["SMPR=1000"] = "1000"
    assert talk(older)[-3:] == ["SMPF=1000", "SMPR=1000", "GSD"]
    assert talk({**older, "SMPF=1000": None})[-3:] == ["SMPF=1000", "SMPR=1000", "GSD"]


def test_firmware_without_dckmd_is_fine_with_sum_only() -> None:
    old = {key: value for key, value in ANSWERS.items() if key != "DCKMD=SUM"}
    assert talk(old)[-1] == "GSD"
    with pytest.raises(SensorSetupWrong, match="DCKMD"):
        talk(old, check="CRC32")


def test_silence_at_the_stop_is_allowed() -> None:
    assert talk({**ANSWERS, "GSD=STOP": None})[-1] == "GSD"


def test_counts_need_zero_gain_and_excitation() -> None:
    text = "SGDM=(A01,A02,A03,A04,A05,A06);C;1;(WMA:1)"
    six = ";".join(["1.0"] * 6)
    answers = {**ANSWERS, text: "", "SGDM=?": FORMAT.format(unit="C")}
    answers |= {"AMPZ=?": six, "CHNAPG=?": six, "EXMV=?": six}
    assert talk(answers, unit="C")[-4:] == ["AMPZ=?", "CHNAPG=?", "EXMV=?", "GSD"]
    answers["DCPCU=?"] = "MV"
    assert talk(answers, unit="C", raw_unit="MV")[-3:] == ["AMPZ=?", "CHNAPG=?", "GSD"]


@pytest.mark.parametrize(
    ("change", "fault", "words"),
    [
        ({"DCPCU=?": "MV"}, SensorSetupWrong, "DCPCU"),
        ({"DCPCU=?": None}, ReplyTimeout, "DCPCU"),
        ({"DCPM=?": "(1,2)"}, SensorSetupWrong, "DCPM"),
        ({"DCKMD=SUM": "CRC32"}, SensorSetupWrong, "DCKMD"),
        ({"SGDM=?": FORMAT.format(unit="C")}, SensorSetupWrong, "SGDM"),
        ({"SGDM=?": "nonsense"}, SensorSetupWrong, "SGDM"),
        ({"SMPF=1000": "500"}, SensorSetupWrong, "SMPF"),
    ],
)
def test_what_does_not_fit(
    change: dict[str, str | None], fault: type[Exception], words: str
) -> None:
    with pytest.raises(fault, match=words):
        talk({**ANSWERS, **change})


def test_can_stops_before_it_starts() -> None:
    assert [exchange.send for exchange in CanStartUp().run()] == [b"\x00", b"\x02"]


@pytest.mark.parametrize(
    "expected", [None, tuple(tuple(float(i == j) for j in range(6)) for i in range(6))]
)
def test_a_matrix_that_is_no_number_is_refused(expected: object) -> None:
    broken = MATRIX.replace("1.0", "nan", 1)
    with pytest.raises(SensorSetupWrong, match=r"matrix \(DCPM\)"):
        talk(ANSWERS | {"DCPM=?": broken}, matrix=expected)


@pytest.mark.parametrize("broken", ["CHNAPG=?", "EXMV=?"])
@pytest.mark.parametrize("values", ["1;1;0;1;1;1", "1;1;-5;1;1;1", "1;1;nan;1;1;1"])
def test_factors_that_cannot_be_divided_by_are_refused(broken: str, values: str) -> None:
    answers = ANSWERS | {
        "SGDM=(A01,A02,A03,A04,A05,A06);C;1;(WMA:1)": FORMAT.format(unit="C"),
        "SGDM=?": FORMAT.format(unit="C"),
        "AMPZ=?": "0;0;0;0;0;0",
        "CHNAPG=?": "1;1;1;1;1;1",
        "EXMV=?": "5;5;5;5;5;5",
    }
    talk(answers, unit="C")
    with pytest.raises(SensorSetupWrong, match=broken.removesuffix("=?")):
        talk(answers | {broken: values}, unit="C")
