"""Lesson 01: wrong answers and right ones; see ``test_answers``."""

LOOPS_2 = """
def my_front_end(obs_xy_world, obs_class, reach):
    labels = []
    for k in range(len(obs_class)):
        best, found = reach, None
        for j in range(k):
            gap = ((obs_xy_world[j] - obs_xy_world[k]) ** 2).sum() ** 0.5
            if obs_class[j] == obs_class[k] and gap < best:
                best, found = gap, labels[j]
        labels.append(len(set(labels)) if found is None else found)
    return labels
"""

PLAIN_RECURSION_3 = """
from math import comb


def bell(n):
    return 1 if n == 0 else sum(comb(n - 1, k) * bell(k) for k in range(n))
"""

MEMORY_3 = """
import functools

bell = functools.cache(lambda n: 1 if n == 0 else sum(math.comb(n - 1, k) * bell(k) for k in range(n)))
"""

FLOATS_3 = """
from scipy.special import comb


def bell(n):
    ways = [1.0]
    for m in range(n):
        ways.append(sum(comb(m, k) * ways[k] for k in range(m + 1)))
    return ways[n]
"""

DECIMALS_3 = """
from decimal import Decimal


def bell(n):
    ways = [Decimal(1)]
    for m in range(n):
        ways.append(sum(math.comb(m, k) * ways[k] for k in range(m + 1)))
    return ways[n]
"""

WRONG = {
    1: {
        "what is kept": "lambda p: (p.argmax(axis=1), p.max(axis=1))",
        "swapped": "lambda p: (1 - p.max(axis=1), p.argmax(axis=1))",
        "by column": "lambda p: (p.argmax(axis=0), 1 - p.max(axis=0))",
        "from one": "lambda p: (p.argmax(axis=1) + 1, 1 - p.max(axis=1))",
        "least": "lambda p: (p.argmin(axis=1), 1 - p.max(axis=1))",
        "runner-up": "lambda p: (p.argmax(axis=1), np.sort(p, axis=1)[:, -2])",
        "classes alone": "lambda p: p.argmax(axis=1)",
        "first row alone": "lambda p: (p[0].argmax(), 1 - p[0].max())",
        "doubt of the mean": "lambda p: (p.argmax(axis=1), 1 - p.mean(axis=1))",
        "three rows only": "lambda p: (p[:3].argmax(axis=1), 1 - p[:3].max(axis=1))",
    },
    2: {
        "nothing joins": "lambda xy, c, reach: np.arange(len(xy))",
        "all one": "lambda xy, c, reach: np.zeros(len(xy), dtype=int)",
        "classes are objects": "lambda xy, c, reach: c",
        "without class": ("obs_class[:k] == obs_class[k]", "obs_class[:k] >= 0"),
        "up to the reach": ("< reach", "<= reach"),
        "half the reach": ("< reach", "< reach / 2"),
        "fixed reach": ("< reach", "< 0.5"),
        "furthest": ("np.argmin(distance)", "np.argmax(np.where(distance < reach, distance, -1))"),
        "first within reach": ("np.argmin(distance)", "np.flatnonzero(distance < reach)[0]"),
        "index for label": ("labels[np.argmin(distance)]", "int(np.argmin(distance))"),
        "x only": (
            "np.linalg.norm(obs_xy_world[:k] - obs_xy_world[k], axis=1)",
            "abs(obs_xy_world[:k, 0] - obs_xy_world[k, 0])",
        ),
        "never a new number": ("num_objects += 1", "num_objects += 0"),
    },
    3: {
        "powers": "lambda n: 2 ** (n - 1)",
        "subsets": "lambda n: 2**n",
        "orders": "math.factorial",
        "Catalan": "lambda n: math.comb(2 * n, n) // (n + 1)",
        "one off": ("return ways[n]", "return ways[n - 1]"),
        "table of ten": "lambda n: [1, 1, 2, 5, 15, 52, 203, 877, 4140, 21147, 115975][n]",
        "table of eleven": "lambda n: ([1, 1, 2, 5, 15, 52, 203, 877, 4140, 21147, 115975, 678570] + 99 * [0])[n]",
        "64 bits": (
            "return ways[n]",
            "return np.array([w % 2**64 for w in ways], dtype=np.uint64).astype(np.int64)[n]",
        ),
        "text": ("return ways[n]", "return str(ways[n])"),
        "stops without a sighting": ("ways = [1]", "ways = [1][: n or None] if n else []"),
        "last digit off above 12": ("return ways[n]", "return ways[n] + (n > 12)"),
        "list above 12": ("return ways[n]", "return ways[n] if n < 12 else [1]"),
        "dictionary above 12": ("return ways[n]", "return ways[n] if n < 12 else {}"),
        "object above 12": ("return ways[n]", "return ways[n] if n < 12 else object()"),
        "complex above 12": ("return ways[n]", "return ways[n] if n < 12 else 1j"),
        "two numbers above 12": ("return ways[n]", "return ways[n] if n < 12 else np.array([5, 6])"),
        "infinite above 12": ("return ways[n]", "return ways[n] if n < 12 else np.array(np.inf)"),
        "always 52": "lambda n: 52",
        "fixed up to 16": ("for m in range(n)", "for m in range(min(n, 16))"),
    },
    4: {
        "upside down": ("chi2 > dof", "chi2 < dof"),
        "always": "lambda chi2, m, k: True",
        "never": "lambda chi2, m, k: False",
        "no spread": ("+ 3 * math.sqrt(2 * dof)", ""),
        "two deviations": ("3 *", "2 *"),
        "variance": ("math.sqrt(2 * dof)", "2 * dof"),
        "objects forgotten": ("- 2 * num_objects", ""),
        "whole threshold": ("chi2 > dof + 3 * math.sqrt(2 * dof)", "chi2 > int(dof + 3 * math.sqrt(2 * dof))"),
        "rounded up": ("chi2 > dof + 3 * math.sqrt(2 * dof)", "chi2 > math.ceil(dof + 3 * math.sqrt(2 * dof))"),
        "counts alone": ("2 * num_observations - 2 * num_objects", "num_observations - num_objects"),
        "not when exactly there": ("chi2 >", "chi2 >="),
        "rings at zero": ("return False", "return True"),
        "fixed": "lambda chi2, m, k: chi2 > 13.3",
        "text": "lambda chi2, m, k: str(chi2 > 2 * (m - k) + 3 * math.sqrt(4 * (m - k)))",
    },
}
RIGHT = {
    1: {
        "comprehension": "lambda p: ([max(range(len(r)), key=lambda c: r[c]) for r in p], [1 - max(r) for r in p])",
        "by sorting": "lambda p: (np.argsort(p, axis=1)[:, -1], np.sort(p, axis=1)[:, :-1].sum(axis=1))",
        "one array": "lambda p: np.stack([p.argmax(axis=1), 1 - p.max(axis=1)])",
    },
    2: {
        "loops": LOOPS_2,
        "other names": ("return np.array(labels)", "return 1000 - 7 * np.array(labels)"),
        "floats": ("return np.array(labels)", "return [float(label) for label in labels]"),
    },
    3: {
        "plain recursion": PLAIN_RECURSION_3,
        "memory": MEMORY_3,
        "triangle": (
            (
                "ways = [1]\n"
                "    for m in range(n):\n"
                "        ways.append(sum(math.comb(m, k) * ways[k] for k in range(m + 1)))\n"
                "    return ways[n]"
            ),
            (
                "row = [1]\n"
                "    for _ in range(n - 1):\n"
                "        row = np.cumsum([row[-1]] + row, dtype=object).tolist()\n"
                "    return row[-1]"
            ),
        ),
        "floats": FLOATS_3,
        "decimals": DECIMALS_3,
        "array of one float": ("return ways[n]", "return np.array(float(ways[n]))"),
        "array of one integer of any size": ("return ways[n]", "return np.array(ways[n], dtype=object)"),
    },
    4: {
        "score": "lambda chi2, m, k: m > k and (chi2 - 2 * (m - k)) / math.sqrt(4 * (m - k)) > 3",
        "one or zero": "lambda chi2, m, k: int(m > k and chi2 > 2 * (m - k) + 6 * math.sqrt(m - k))",
        "of NumPy": "lambda chi2, m, k: np.logical_and(m > k, chi2 > 2 * (m - k) + 3 * np.sqrt(4 * (m - k)))",
    },
}
