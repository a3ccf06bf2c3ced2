"""The drawing lesson, ``notebooks/draw_your_own_world.ipynb``: its page, and the messages between page and kernel."""
