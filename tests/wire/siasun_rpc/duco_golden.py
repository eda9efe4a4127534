"""Literal bytes of the remote interface (docs/protocols/siasun-rpc.md, section 2)."""

STOP_CALL = bytes.fromhex("80010001 00000004 73746f70 00000000 02 0001 01 00")
STOP_REPLY_4 = bytes.fromhex("80010002 00000004 73746f70 00000000 08 0000 00000004 00")
STATE_FIELD = bytes.fromhex("0f 0000 03 00000004 06 00 05 02 00")
STATE_REPLY = bytes.fromhex("80010002 0000000f") + b"get_robot_state" + bytes(4) + STATE_FIELD
