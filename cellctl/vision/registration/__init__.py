"""From measured points to the pose of a part: weighted fit, its covariance, and its consistency."""
