"""What a controller has said in its hellos, in words for whoever commissions it."""

from collections.abc import Mapping

from drivers.robot.siasun.connection import SjlChannel


def link_facts(channels: Mapping[str, SjlChannel]) -> dict[str, str]:
    """Words by name; of a channel that is not connected only that."""
    facts: dict[str, str] = {}
    for name, channel in channels.items():
        if not channel.connected:
            facts[name] = "not connected"
            continue
        hello = channel.hello
        facts[name] = (
            f"connected, SJL/{hello.version}, {hello.robot}, job program {hello.job_version}, "
            f"session {channel.session}"
        )
        facts["conventions"] = f"{hello.euler}, {hello.unit}"
        facts["limit of a step"] = f"{hello.step_max_mm:g} mm"
        facts["dead man"] = f"{hello.deadman_ms} ms"
        # By the one channel whose job program streams.
        if hello.stream is not None:
            facts["streamed motion"] = "offered"
        facts.setdefault("streamed motion", "not offered")
    # By convention of the protocol; the controller cannot be asked for another one.
    facts["tool and user frame"] = "0 and 0: flange and base"
    return facts
