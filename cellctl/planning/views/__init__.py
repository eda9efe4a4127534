"""Where the heads stand: what they see from there, how certain the pose is, which place is best.

Covariances come from the estimators of ``cellctl.vision`` themselves; ``hole_image`` alone is a
model: how uncertain a hole's centre is in two images.
"""
