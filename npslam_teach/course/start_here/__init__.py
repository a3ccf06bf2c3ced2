"""Lesson 00: the whole problem at a glance."""
