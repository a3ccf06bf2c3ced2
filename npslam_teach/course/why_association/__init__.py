"""Lesson 01, ``notebooks/01_why_association.ipynb``: its pictures, checks, figures and explorer."""
