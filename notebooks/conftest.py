"""Lessons are compared with their committed outputs, in which explorers have their frames."""

import os

os.environ["NPSLAM_TEACH_FRAMES"] = "1"
# A kernel inherits these. Matrices here are small, and threads of several kernels that share the
# cores would wait for each other until a cell runs out of time.
for _name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(_name, "1")
