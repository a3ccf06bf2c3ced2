"""What must work before anything is installed: the course's environment, files, and Ctrl-C."""
