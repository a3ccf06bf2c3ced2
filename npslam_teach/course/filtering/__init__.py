"""Lesson 09, ``notebooks/09_filtering.ipynb``: its pictures, checks, figures and explorer."""
