"""Lesson 15, a frame at a time: pictures, checks, figures, the explorer and the table of runs."""
