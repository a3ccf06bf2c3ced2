"""Lesson 06, ``notebooks/06_alternation.ipynb``: its pictures, checks, figures and explorer."""
