"""Times that protect and are too long or too short for it."""

from tests.unit.config.mistake import Mistake, deck

_MAIN = "robots.main.settings"
_SENSOR = "force_sensors.force"


def _real(old: str, new: str, key: str, said: str) -> Mistake:
    """A mistake in the template, after a key that stands there."""
    return Mistake("cell.toml", old, f"{old}\n{new}", key, said)


def _pin(old: str, new: str, key: str, said: str) -> Mistake:
    return Mistake("insertion-pin.toml", old, new, key, said)


_PORT = "state_port = 7002"
_AUX_PORT = "state_port = 7012"
TOO_LONG = (
    deck("max_deadman_s = 1.5", "max_deadman_s = 60.0", f"{_MAIN}.max_deadman_s", "at most 2 s"),
    deck("silence_s = 1.5", "silence_s = 60.0", f"{_MAIN}.silence_s", "goes on unseen"),
    deck(
        "silence_s = 1.5\nstale_s = 0.5",
        "silence_s = 1.5\nstale_s = 1.2",
        f"{_MAIN}.stale_s",
        "1 s",
    ),
    deck("max_lag_s = 0.9", "max_lag_s = 60.0", f"{_SENSOR}.settings.max_lag_s", "50 N"),
    deck("flange_age_ms = 600.0", "flange_age_ms = 6000.0", f"{_SENSOR}.flange_age_ms", "1000"),
    deck(
        "heartbeat_timeout_s = 3.0", "heartbeat_timeout_s = 9.0", "plc.heartbeat_timeout_s", "line"
    ),
    deck(
        "guard_port = 7003, max_deadman_s = 1.5",
        "guard_port = 7003, max_deadman_s = 15",
        f"{_SENSOR}.stop_channel.settings.max_deadman_s",
        "at most 2 s",
    ),
    deck(
        "stale_s = 0.5", "stale_s = 0.5\nstop_timeout_s = 60.0", f"{_MAIN}.stop_timeout_s", "late"
    ),
    deck(
        "stale_s = 0.5", "stale_s = 0.5\nreply_timeout_s = 60.0", f"{_MAIN}.reply_timeout_s", "late"
    ),
    _real(_PORT, "max_deadman_s = 1.1", f"{_MAIN}.max_deadman_s", "at most 1 s"),
    _real(_PORT, "silence_s = 5.0", f"{_MAIN}.silence_s", "at most 1 s"),
    _real(_PORT, "stale_s = 5.0", f"{_MAIN}.stale_s", "at most 0.5"),
    _real(
        _AUX_PORT,
        "max_deadman_s = 0.7",
        "robots.aux_1.settings.max_deadman_s",
        "at most 0.6 s: an arm that has lost this PC goes on for so long: 150 mm at 250 mm/s",
    ),
    Mistake("cell.toml", "stale_ms = 10.0", "stale_ms = 200.0", f"{_SENSOR}.stale_ms", "100 N"),
    Mistake(
        "cell.toml",
        "rate_hz = 1000,",
        "rate_hz = 1000, max_lag_s = 1.0,",
        f"{_SENSOR}.settings.max_lag_s",
        "at most 0.5 s",
    ),
    Mistake(
        "cell.toml",
        'host = "192.168.20.31",',
        'host = "192.168.20.31", max_watchdog_s = 30.0,',
        "digital_ios.permit.settings.max_watchdog_s",
        "a permit included",
    ),
    _pin(
        "max_stream_loss_s = 0.5",
        "max_stream_loss_s = 5.0",
        "robots.arm.settings.max_stream_loss_s",
        "1",
    ),
)
TOO_SHORT = (
    deck("max_deadman_s = 1.5", "max_deadman_s = 0.05", f"{_MAIN}.max_deadman_s", "at least 0.1"),
    deck("max_lag_s = 0.9", "max_lag_s = 0.001", f"{_SENSOR}.settings.max_lag_s", "at least 0.02"),
    deck(
        "silence_s = 1.5\nstale_s = 0.5",
        "silence_s = 0.5\nstale_s = 0.9",
        f"{_MAIN}.stale_s",
        "counts as lost",
    ),
    deck(
        "stale_s = 0.5",
        "stale_s = 0.5\nstop_timeout_s = 0.2",
        f"{_MAIN}.stop_timeout_s",
        "stop_latency measured",
    ),
    Mistake(
        "antenna-rpc.toml",
        "silence_s = 1.5 ",
        "silence_s = 0.05\npoll_period_s = 0.02 ",
        "robots.arm.settings.silence_s",
        "three times poll_period_s",
    ),
    Mistake(
        "cell.toml",
        "rate_hz = 1000,",
        "rate_hz = 1000, points = 10,",
        f"{_SENSOR}.stale_ms",
        "at least 20, two frames",
        at_the_other=True,
    ),
)
PROTECTIVE = TOO_LONG + TOO_SHORT
