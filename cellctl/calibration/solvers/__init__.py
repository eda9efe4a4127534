"""One package per solver, each with its input file, result and picture.

``adjustment`` is the least-squares solution with covariance that several of them share;
``pose_average`` is the weighted mean of poses.
"""
