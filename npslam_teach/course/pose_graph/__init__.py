"""Lesson 03, ``notebooks/03_pose_graph.ipynb``: its pictures, checks, figures and explorer."""
