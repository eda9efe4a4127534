"""Zones that two arms may not share: who may move into which, by what the robots report.

``zone`` is a zone and each robot's share of it, ``ways`` says which of them a move needs,
``arbiter`` grants them, and ``zoned_robot`` asks the arbiter before every move of a robot.
"""
