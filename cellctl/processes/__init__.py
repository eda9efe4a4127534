"""The processes that come with cellctl, one package each.

A process is found by its entry point ``cellctl.process``. It may use everything below it, nothing
below it knows it, and no process knows another: what two of them share moves down.
"""
