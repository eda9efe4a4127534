import struct

from hypothesis import given
from hypothesis import strategies as st

from drivers.ftsensor.sri.can_frames import RECORD, TripleDecoder
from drivers.ftsensor.sri.protocol import Frame

IDS = (0x291, 0x292, 0x293)


def record(identifier: int, *pair: float) -> bytes:
    return RECORD.pack(identifier, struct.pack("<2f", *pair))


def triple(base: float) -> list[bytes]:
    return [record(number, base + 2 * k, base + 2 * k + 1) for k, number in enumerate(IDS)]


def test_three_messages_make_a_sample() -> None:
    found = TripleDecoder(IDS).feed(b"".join(triple(1.0) + triple(7.0)))
    assert found == [Frame(0, ((1, 2, 3, 4, 5, 6),)), Frame(1, ((7, 8, 9, 10, 11, 12),))]


def test_a_lost_message_costs_its_sample_and_shows_as_a_gap() -> None:
    for missing in range(3):
        messages = triple(1.0) + triple(10.0) + triple(20.0)
        del messages[3 + missing]
        found = TripleDecoder(IDS).feed(b"".join(messages))
        assert [frame.points[0][0] for frame in found if isinstance(frame, Frame)] == [1.0, 20.0]
        assert [frame.number for frame in found if isinstance(frame, Frame)] == [0, 2]


@given(st.lists(st.sampled_from([*IDS, 0x123]), max_size=40))
def test_fuzz_two_samples_are_never_mixed(order: list[int]) -> None:
    """Every value carries its message's place: the three of one sample lie side by side."""
    own = [number for number in order if number in IDS]
    places_of_own = iter(range(len(own)))
    place = [next(places_of_own) if number in IDS else -1 for number in order]
    pairs = zip(order, place, strict=True)
    data = b"".join(record(number, float(k), float(k)) for number, k in pairs)
    for frame in TripleDecoder(IDS).feed(data):
        assert isinstance(frame, Frame)
        places = frame.points[0][::2]
        assert places == (places[0], places[0] + 1, places[0] + 2)
