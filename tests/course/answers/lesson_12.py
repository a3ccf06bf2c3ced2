"""Lesson 12: wrong answers and right ones; see ``test_answers``."""

ANY_OBJECT_5 = """
def first_of_each_pass(x, t, g):
    chosen, last = np.zeros(len(x), dtype=bool), None
    for m in np.argsort(t):
        if x[m] >= 0:
            chosen[m] = last is None or t[m] - last > g
            last = t[m]
    return chosen
"""

FROM_THE_BEGINNING_5 = """
def first_of_each_pass(x, t, g):
    chosen, began = np.zeros(len(x), dtype=bool), {}
    for m in np.argsort(t):
        if x[m] >= 0 and t[m] - began.get(x[m], -(10**9)) > g:
            chosen[m], began[x[m]] = True, t[m]
    return chosen
"""

LOOP_1 = """
def hidden(codes, barcodes, n):
    out = []
    for code in codes:
        i = int(barcodes[barcodes[:, 1] == code, 0][0]) - 6
        out.append(i % n if i >= 0 else -1)
    return out
"""

SORTED_1 = """
def hidden(codes, barcodes, n):
    order = np.argsort(barcodes[:, 1])
    i = barcodes[order, 0][np.searchsorted(barcodes[order, 1], codes)] - 6
    return np.where(i < 0, -1, i % n)
"""

MATRIX_1 = """
lambda codes, b, n: np.where((i := ((codes[:, None] == b[:, 1]) @ b[:, 0]) - 6) >= 0, i % n, -1)
"""

LOOP_2 = """
def lag_one(e, p):
    pairs = [e[k] * e[k + 1] for k in range(len(e) - 1) if p[k] == p[k + 1]]
    return sum(pairs) / len(pairs) / (sum(x * x for x in e) / len(e))
"""

BY_PASS_2 = """
def lag_one(e, p):
    products = np.concatenate([e[p == k][1:] * e[p == k][:-1] for k in np.unique(p)])
    return products.mean() / (e @ e / len(e))
"""

STRETCHES_3 = """
def growth(odometry, poses, n):
    off = []
    for begin in range(len(odometry) - n + 1):
        wheels = np.zeros(3)
        for step in odometry[begin : begin + n]:
            wheels = se2.compose(wheels, step)
        each = wheels - se2.between(poses[begin], poses[begin + n])
        off.append([each[0], each[1], se2.wrap(each[2])])
    return np.sqrt(np.mean(np.square(off), axis=0))
"""

CHI2_4 = """
from scipy.stats import chi2

share_outside = lambda off, std, gate: np.mean(((off / std) ** 2).sum(axis=1) > chi2.ppf(gate, 2))
"""

PROBABILITY_4 = """
lambda off, std, gate: (np.exp(-((off / std) ** 2).sum(axis=1) / 2) < 1 - gate).sum() / len(off)
"""

LOOP_4 = """
from math import log

share_outside = lambda off, std, gate: (
    sum((x / std[0]) ** 2 + (y / std[1]) ** 2 > -2 * log(1 - gate) for x, y in off) / len(off)
)
"""

IN_ORDER_OF_TIME_5 = """
def first_of_each_pass(labels, times, gap):
    chosen, last = [False] * len(labels), {}
    for m in sorted(range(len(labels)), key=lambda m: times[m]):
        k = labels[m]
        if k >= 0:
            chosen[m] = k not in last or times[m] - last[k] > gap
            last[k] = times[m]
    return chosen
"""

ANY_EARLIER_ONE_5 = """
lambda x, t, g: [
    bool(x[m] >= 0 and not ((x == x[m]) & (t < t[m]) & (t >= t[m] - g)).any()) for m in range(len(x))
]
"""

LEXSORT_5 = """
def first_of_each_pass(x, t, g):
    if not len(x):
        return np.zeros(0, dtype=bool)
    o = np.lexsort((t, x))
    new = np.r_[True, (np.diff(x[o]) != 0) | (np.diff(t[o]) > g)]
    out = np.zeros(len(x), dtype=int)
    out[o] = new & (x[o] >= 0)
    return out
"""

WRONG = {
    1: {
        "which landmark": ("landmark % num_classes", "landmark"),
        "from subject 0": ("- 6", "- 0"),
        "from subject 5": ("- 6", "- 5"),
        "robots too": ("np.where(landmark < 0, -1, landmark % num_classes)", "landmark % num_classes"),
        "codes themselves": ("subject[code] for code", "code for code"),
        "quotient": ("landmark % num_classes", "landmark // num_classes"),
        "five classes": ("% num_classes", "% 5"),
        "zero for robots": ("landmark < 0, -1", "landmark < 0, 0"),
        "in the table's order": (
            "{code: number for number, code in barcodes}",
            "{code: i + 1 for i, (number, code) in enumerate(barcodes)}",
        ),
        "landmarks alone": (
            "return np.where(landmark < 0, -1, landmark % num_classes)",
            "return landmark[landmark >= 0] % num_classes",
        ),
        "text": (
            "return np.where(landmark < 0, -1, landmark % num_classes)",
            "return np.where(landmark < 0, -1, landmark % num_classes).astype(str)",
        ),
        "table turned round": ("for number, code in", "for code, number in"),
    },
    2: {
        "across passes": ("same_pass = passes[1:] == passes[:-1]", "same_pass = passes[1:] >= -(10**9)"),
        "covariance": (" / np.mean(errors**2)", ""),
        "sums": (
            "np.mean((errors[1:] * errors[:-1])[same_pass]) / np.mean(errors**2)",
            "np.sum((errors[1:] * errors[:-1])[same_pass]) / np.sum(errors**2)",
        ),
        "centred": ("same_pass =", ("errors = errors - errors.mean()\n    same_pass =")),
        "two apart": "lambda e, p: np.mean((e[2:] * e[:-2])[p[2:] == p[:-2]]) / np.mean(e**2)",
        "root below": ("np.mean(errors**2)", "np.sqrt(np.mean(errors**2))"),
        "corrcoef": "lambda e, p: np.corrcoef(e[1:], e[:-1])[0, 1]",
        "below of neighbours": ("np.mean(errors**2)", "np.mean(errors[1:][same_pass] ** 2)"),
        "absolute": ("errors[1:] * errors[:-1]", "np.abs(errors[1:] * errors[:-1])"),
        "mean of ratios": (
            "np.mean((errors[1:] * errors[:-1])[same_pass]) / np.mean(errors**2)",
            "np.mean((errors[1:] / errors[:-1])[same_pass])",
        ),
        "in place": ("same_pass =", ("errors -= 0.1\n    same_pass =")),
    },
    3: {
        "not wrapped": ("se2.wrap(off[:, 2])", "off[:, 2]"),
        "in the world": (
            "se2.between(wheels[:-n], wheels[n:]) - se2.between(poses[:-n], poses[n:])",
            "(wheels[n:] - wheels[:-n]) - (poses[n:] - poses[:-n])",
        ),
        "mean square": ("np.sqrt(np.mean(off**2, axis=0))", "np.mean(off**2, axis=0)"),
        "standard deviation": ("np.sqrt(np.mean(off**2, axis=0))", "off.std(axis=0)"),
        "every n-th": ("np.sqrt(np.mean(off**2, axis=0))", "np.sqrt(np.mean(off[::n] ** 2, axis=0))"),
        "mean of sizes": ("np.sqrt(np.mean(off**2, axis=0))", "np.mean(abs(off), axis=0)"),
        "first stretch": ("np.sqrt(np.mean(off**2, axis=0))", "abs(off[0])"),
        "single steps": ("wheels = se2", ("root, n = n**0.5, 1\n    wheels = se2")),
        "added": ("se2.dead_reckoning(odometry)", "np.vstack([np.zeros(3), np.cumsum(odometry, axis=0)])"),
        "one number": ("np.sqrt(np.mean(off**2, axis=0))", "np.sqrt(np.mean(off**2))"),
        "last": ("poses[:-n], poses[n:]", "poses[n:], poses[:-n]"),
        "largest": ("np.sqrt(np.mean(off**2, axis=0))", "abs(off).max(axis=0)"),
    },
    4: {
        "inside": ("squared >", "squared <"),
        "not squared": ("np.sum((off / std) ** 2, axis=1)", "np.sqrt(np.sum((off / std) ** 2, axis=1))"),
        "variance": ("off / std", "off / std**2"),
        "how many": ("np.mean(", "np.sum("),
        "either": ("np.sum((off / std) ** 2, axis=1)", "np.max((off / std) ** 2, axis=1)"),
        "no 2": ("-2 * np.log", "-np.log"),
        "one number": (
            "np.mean(squared > -2 * np.log(1 - gate))",
            "np.mean(squared > __import__('scipy.stats').stats.chi2.ppf(gate, 1))",
        ),
        "per cent": ("np.mean(squared > -2 * np.log(1 - gate))", "100 * np.mean(squared > -2 * np.log(1 - gate))"),
        "fixed": ("np.mean(squared > -2 * np.log(1 - gate))", "np.mean(squared > 9.21)"),
        "gate": ("np.mean(squared > -2 * np.log(1 - gate))", "1 - gate"),
        "which": ("np.mean(squared > -2 * np.log(1 - gate))", "squared > -2 * np.log(1 - gate)"),
        "three standard deviations": ("np.mean(squared > -2 * np.log(1 - gate))", "np.mean(squared > 9)"),
    },
    5: {
        "reaches": ("> gap", ">= gap"),
        "-1 too": ("labels[labels >= 0]", "labels"),
        "last": ("np.append(True, np.diff(times[own]) > gap)", "np.append(np.diff(times[own]) > gap, True)"),
        "first alone": ("own[np.append(True, np.diff(times[own]) > gap)]", "own[:1]"),
        "not in order": (("own = own[np.argsort(times[own])]\n        "), ""),
        "others": ("return chosen", "return ~chosen"),
        "all": "lambda x, t, g: x >= 0",
        "indices": ("return chosen", "return np.flatnonzero(chosen)"),
        "any object": ANY_OBJECT_5,
        "from the beginning": FROM_THE_BEGINNING_5,
        "in place": ("chosen = np.zeros", ("times.sort()\n    chosen = np.zeros")),
        "fixed gap": ("> gap", "> 5"),
        "no object 0": ("labels >= 0", "labels > 0"),
    },
}
RIGHT = {
    1: {
        "loop": LOOP_1,
        "sorted": SORTED_1,
        "matrix": MATRIX_1,
    },
    2: {
        "loop": LOOP_2,
        "by pass": BY_PASS_2,
        "average": "lambda e, p: np.average(e[1:] * e[:-1], weights=p[1:] == p[:-1]) / np.mean(np.square(e))",
    },
    3: {
        "stretches": STRETCHES_3,
        "difference of motions": ("off[:, 2] = se2.wrap(off[:, 2])", "off[:, 2] = np.angle(np.exp(1j * off[:, 2]))"),
        "from the true start": ("se2.dead_reckoning(odometry)", "se2.dead_reckoning(odometry, poses[0])"),
    },
    4: {
        "chi2": CHI2_4,
        "probability": PROBABILITY_4,
        "loop": LOOP_4,
    },
    5: {
        "in order of time": IN_ORDER_OF_TIME_5,
        "any earlier one": ANY_EARLIER_ONE_5,
        "lexsort": LEXSORT_5,
    },
}
