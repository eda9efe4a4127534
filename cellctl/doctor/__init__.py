"""Whether this PC can run the cell: what the service needs of it, each with its remedy.

``doctor.diagnose`` goes through the subjects in the order in which they hinder a start. Each module
looks at one of them and yields a ``Finding`` for everything it looked at, good ones as well. What
it looks at comes from a ``Pc``, so that a test can show it another one. Nothing here changes the PC
or sends a byte to a device.
"""
