"""Lesson 13, a chair that is called cup: pictures, checks, figures, the explorer and the table of runs."""
