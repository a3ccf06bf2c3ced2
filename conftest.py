"""For tests and notebooks alike: outputs are compared with what is committed, explorers with their frames."""

import os

os.environ["NPSLAM_TEACH_FRAMES"] = "1"
