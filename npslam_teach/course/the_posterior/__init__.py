"""Lesson 11, ``notebooks/11_the_posterior.ipynb``: its scenes, pictures, checks, figures and explorers."""
