"""Lessons are compared with their committed outputs, in which explorers have their frames."""

import os

os.environ["NPSLAM_TEACH_FRAMES"] = "1"
for _name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ.setdefault(_name, "1")  # several kernels run at once
