"""Which device has moved since the cell was taught, by gripper marks and plate in the images."""
