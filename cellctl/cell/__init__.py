"""What steps and procedures share: the devices, measuring a part, the present run, progress."""
