"""Whether the judge of insertions finds every fault in time, against a contact model of its own.

- ``trials``: one drawn pair of connectors is plugged under the live watch
- ``campaign``: the table against what is demanded
"""
