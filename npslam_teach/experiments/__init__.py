"""Methods run on scenes: one run (``runs``), the paper's simulation (``paper_simulation``), and where it breaks.

``what_breaks`` makes the table of lesson 10; ``oracles`` gives the paper's method a part of the truth.
``posterior_trials`` says how often ``posterior`` is right, and why not; ``tables`` writes and reads.
"""

from npslam_teach.experiments.runs import Run, Scene, run_method, run_one, run_summary

__all__ = ["Run", "Scene", "run_method", "run_one", "run_summary"]
