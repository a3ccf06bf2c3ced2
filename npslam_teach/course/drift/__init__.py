"""Lesson 02, ``notebooks/02_drift.ipynb``: its pictures, checks, figures and explorer."""
