"""Lesson 07, ``notebooks/07_fifteen_objects.ipynb``: its pictures, checks, figures and explorer."""
