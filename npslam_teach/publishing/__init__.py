"""What is made out of the notebooks: assignments, the book, Colab badges, and the JupyterLite site."""
