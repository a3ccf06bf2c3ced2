"""Lesson 10, ``notebooks/10_what_breaks.ipynb``: its pictures, checks, figures and explorer; ``table`` has its runs."""
