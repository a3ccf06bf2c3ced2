"""Lesson 05, ``notebooks/05_class_votes.ipynb``: its pictures, checks, figures and explorer."""
