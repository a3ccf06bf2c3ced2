"""Lesson 12, ``notebooks/12_a_real_robot.ipynb``: pictures, checks, figures, explorer; ``table`` has its runs."""
