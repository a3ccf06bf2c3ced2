"""Ours and its peers, each behind the same function: ``solve(problem, tolerance)``, from arrays to arrays.

It returns poses (T, 3), landmarks (K, 2), the number of iterations, and a function that tells chi2 by the solver's own
residual (asked for when the clock has stopped).
"""
