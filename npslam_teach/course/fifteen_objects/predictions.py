"""What ``notebooks/07_fifteen_objects.ipynb`` asks before it shows a result, and the words for its pictures."""

from npslam_teach.course.predict import choice, number, questions

predict = questions(
    "07",
    exercises=3,
    clouds=choice(
        "Three chairs: how many clouds of chairs?",
        ["fewer than three", "three", "more than three"],
        right=2,
        mistake="To count chairs. A cloud is a visit; after some drift the same chair stands elsewhere.",
        alts=[("Left: the true path, 15 objects. Right: sightings in clouds, for some objects two or three.")],
    ),
    rounds=number(
        "After how many rounds does no label change any more?",
        mistake=("To expect many. Most is done in the first round, and each later one needs the path to have moved."),
        alts=[
            (
                "Maps of each round: clouds of sightings, then a few objects around each true one, "
                "then exactly one on each of the 15 true objects, the path on the true path."
            ),
            ("Left: objects per round, falling to the dashed true 15. Right: the objective, falling."),
        ],
    ),
    rivals=choice(
        "Too many, too few, and the better path of the last two?",
        [
            "all too many; open loop",
            "open loop and frame by frame too many, robust SLAM too few; the same path",
            "robust SLAM too many, the others too few; frame by frame",
        ],
        right=1,
        mistake=(
            "To expect a better path from fewer objects. What is not matched across the loop says "
            "nothing about the drift."
        ),
        alts=[
            "",
            (
                "Four maps: the NP-graph on the truth with 15 objects; robust SLAM with 5 and a path "
                "still off; open loop with over two hundred objects and frame by frame with over a "
                "thousand, both on the drifted path."
            ),
            (
                "Left: error summed along the path, lowest by far for the NP-graph; open loop and "
                "frame by frame coincide. Right: mean object error against number of objects."
            ),
        ],
    ),
    twenty=choice(
        "How many of twenty rooms end with 15, and how large are the other errors?",
        ["all", "most; the others are a little worse", "most; the others are far worse", "few"],
        right=2,
        mistake="To expect a gentle failure. An object that stays in two holds the path apart.",
        alts=["Mean pose error against objects found in 20 rooms; small at 15, large beyond."],
    ),
    noise=choice(
        "At what noise does it stop finding 15 in most of five rooms?",
        ["at 1.5 times", "at 3 times", "at 5 times", "never"],
        right=0,
        mistake="To trust one good run. There is little room above the paper's noise.",
        alts=[
            "Dots for five rooms each: at noise 1 mostly on the line of 15, at noise 2 mostly above.",
        ],
    ),
    threshold=choice(
        "Which threshold would you choose?",
        ["0.3", "0.1", "0.01"],
        right=2,
        mistake=(
            "To read it as a degree of belief. It is a share, and with fifty earlier sightings beside "
            "it no share is large."
        ),
        alts=[
            (
                "Heat map of the median number of objects over alpha and threshold: 15 at threshold "
                "0.01 and any alpha, and, where the most probable wins, for alpha below 1; hundreds "
                "elsewhere."
            )
        ],
    ),
    chi2=choice(
        "χ² per degree of freedom: all split in two; two chairs as one?",
        ["both far above 1", "about 1; far above 1", "far above 1; about 1", "both about 1"],
        right=1,
        mistake="To think that χ² can count. More objects always fit at least as well.",
        alts=[
            "",
            "The sightings of one object: odd and even ones lie among each other, east and west ones side by side.",
        ],
    ),
)
