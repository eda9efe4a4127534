"""Kinematics of a six-axis arm: its chain, the joints of a pose and those along a straight way."""
