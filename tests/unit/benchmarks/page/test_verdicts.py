"""Commands of the benchmark before the page of a daemon made of paper."""

from pathlib import Path

from benchmarks.page.readers import STREAMS_EACH, add_readers
from benchmarks.page.verdicts import PROGRAMS, commanded
from cellctl.api.local_socket.messages import PlainCommand, Refused, Taken
from cellctl.packml.reject import RejectCode
from fakes.demo.page import write_settings
from tests.rigs.waiting import until_blocking
from tests.unit.hmi.scripted_daemon import PaperDaemon, page_thread, serving


def test_each_command_has_the_verdict_of_the_daemon_and_any_other_answer_is_told(
    tmp_path: Path,
) -> None:
    settings, _ = write_settings(tmp_path)
    add_readers(settings, PROGRAMS * STREAMS_EACH)
    (tmp_path / "store").mkdir()
    code = RejectCode.ROLE_MISSING
    paper = PaperDaemon(answer=Refused(code=code, text=code.text, state="IDLE"))
    with serving(tmp_path / "store/cellctl.sock", paper), page_thread(settings) as url:
        with commanded(url) as verdicts:
            until_blocking(lambda: len(verdicts.took_s) > 1)
        assert verdicts.odd == []
        assert {asked.on_behalf.role for asked in paper.asked} == {"view"}
        assert paper.asked[0].command == PlainCommand(request="hold")
        paper.answer = Taken(state="HELD")
        with commanded(url) as taken:
            until_blocking(lambda: len(taken.odd) > 0)
    assert taken.odd[0].startswith("202 ")


def test_without_a_page_nothing_is_commanded() -> None:
    with commanded("") as verdicts:
        pass
    assert not verdicts.took_s
    assert not verdicts.odd
