"""Methods run on scenes: one run (``runs``), and the paper's simulation (``paper_simulation``)."""

from npslam_teach.experiments.runs import Run, Scene, run_method, run_one, run_summary

__all__ = ["Run", "Scene", "run_method", "run_one", "run_summary"]
