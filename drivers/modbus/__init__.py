"""Digital signals behind a Modbus TCP coupler, shared by the drivers of I/O and grippers
(docs/protocols/modbus-coupler.md).
"""
