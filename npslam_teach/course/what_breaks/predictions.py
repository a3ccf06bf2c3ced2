"""What ``notebooks/10_what_breaks.ipynb`` asks before it shows a result, and the words for its pictures."""

from npslam_teach.course.predict import choice, questions

predict = questions(
    "10",
    exercises=4,
    three_rooms=choice(
        "Right at the paper's noise, and at twice that?",
        ["three and three", "three and one", "two and none", "one and one"],
        right=2,
        mistake="To trust the room of the last lesson.",
    ),
    thirty=choice(
        "All of 30 go right: how low may the true share be?",
        ["0.99", "0.97", "0.89", "0.50"],
        right=2,
        mistake=(
            "To take no failure in thirty rooms for no failure at all. "
            "Thirty rooms may well miss a failure that comes once in twenty."
        ),
        alts=["", "Counts over the true share, as a band; thirty of thirty fit every share from 0.89."],
    ),
    below_half=choice(
        "Where does it fall below one half, and how?",
        ["at half the noise, gently", "between 1.5 and 2 times, steeply", "at 4 times, steeply", "it does not"],
        right=1,
        mistake="To expect a slow decline. Drift either stays within the kernel's reach or it does not.",
        alts=["Shares over noise: NP-graph falls from 1 to 0 between noise 1 and 2.5."],
    ),
    three_knobs=choice(
        "Which of the three settings matters least, and does any help at noise 3?",
        ["α; none helps", "the kernel; α helps", "the threshold; the kernel helps"],
        right=0,
        mistake="To say that nobody tuned it. At noise 3 no value of any of them is right in most rooms.",
        alts=["Shares over alpha, threshold and kernel; none is high at noise 3."],
    ),
    widest=choice(
        "Noise 3 and the widest kernel: how many objects, and which?",
        ["more than 15", "fewer, and the right ones", "fewer, and not the right ones"],
        right=2,
        mistake="To take a number near 15 for success.",
    ),
    scaled=choice(
        "A kernel that fits the sensor: does noise 3 go as well as noise 1?",
        ["yes", "nearly", "no"],
        right=2,
        mistake="To blame the kernel alone. It then fits the camera, and the path is still wrong.",
        alts=["Fixed and scaled kernel fall nearly together; what lesson 11 does stays up."],
    ),
    three_oracles=choice(
        "Which of the three stays right at noise 3?",
        ["true poses alone", "true poses and true start", "all three", "none"],
        right=2,
        mistake=(
            "To look for one culprit. Each of these gifts removes the drift from the first question, "
            "which is where it fails."
        ),
        alts=["", "Shares right: with true poses or start, and the scaled kernel, nearly all."],
    ),
    lowest=choice(
        "Keep the lowest of six orders: how many of 30 at noise 2?",
        ["as many as with one order", "twice as many", "nearly all"],
        right=0,
        mistake="To think that more tries find the truth. All six begin with the same wrong path.",
    ),
    which_pair=choice(
        "Which pair may be one chair, and what does the kernel say?",
        [
            "the first; it prefers the first",
            "the first; it says the same to both",
            "the second; it prefers the second",
            "both; it says the same",
        ],
        right=1,
        mistake=(
            "To take half a metre for half a metre. It may be well within the drift, or far outside "
            "of what can be when the drift is shared."
        ),
        alts=["", "Three passes with bars; the first difference nearly reaches zero, the second does not."],
    ),
    beyond=choice(
        "Of true pairs, how many lie beyond the kernel's reach, and beyond the gate?",
        ["few; few", "most; few", "few; most", "most; most"],
        right=1,
        mistake=(
            "To expect that both are thresholds on a distance. One is in metres, the other in standard deviations."
        ),
        alts=["Pairs of passes: the gate keeps nearly all true ones, the kernel few."],
    ),
    some_kernel=choice(
        "Some kernel is right in how many rooms, and does a chosen one do as well elsewhere?",
        ["in all; yes", "in half; as well, but badly in both", "in half; no, far worse", "in none"],
        right=1,
        mistake="To choose by the truth. A kernel for each room needs the answer in advance.",
        alts=["Thirty rooms at noise 2: those that found 15 all have small errors."],
    ),
)
