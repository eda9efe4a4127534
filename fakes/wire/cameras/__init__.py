"""Frame servers of cameras and stereo heads (CFS/1), target servers of trackers (TGT/1)."""
