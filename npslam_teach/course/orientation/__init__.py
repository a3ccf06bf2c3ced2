"""Lesson 14, which way does it face: pictures, checks, figures, the explorer and the table of runs."""
