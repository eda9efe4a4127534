"""What a demonstration needs of the network, said before anything starts."""

import pytest

from fakes.demo.ports import HOST, NoLoopback, require_network


def test_a_pc_that_does_not_reach_itself_is_told_how() -> None:
    require_network(HOST)
    # No program may send there without asking for it, and it is refused like a missing network.
    with pytest.raises(NoLoopback, match="ip link set lo up"):
        require_network("255.255.255.255")
