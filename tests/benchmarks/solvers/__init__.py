"""Ours and its peers, each behind the same function: ``solve(problem, tolerance)``, from arrays to arrays.

It returns poses (T, 3), landmarks (K, 2), the number of iterations, and a function that is asked when the clock has
stopped: ``own_chi2``, by the solver's own residual, and of a certificate ``certificate_status`` and
``certificate_seconds``.
"""
