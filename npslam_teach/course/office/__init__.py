"""Lesson 08, ``notebooks/08_office.ipynb``: its pictures, checks, figures and explorer."""
