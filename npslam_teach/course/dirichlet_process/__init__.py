"""Lesson 04, ``notebooks/04_dirichlet_process.ipynb``: its pictures, checks, figures and explorer."""
