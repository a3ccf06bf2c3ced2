"""Lessons are compared with their committed outputs, in which explorers have their frames."""

import os

os.environ["NPSLAM_TEACH_FRAMES"] = "1"
