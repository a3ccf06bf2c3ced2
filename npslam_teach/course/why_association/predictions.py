"""What ``notebooks/01_why_association.ipynb`` asks before it shows a result, and the words for its pictures."""

from npslam_teach.course.predict import choice, number, questions

predict = questions(
    "01",
    exercises=4,
    history=choice(
        "When did a robot first find its way between chairs with a camera?",
        ["in the 1970s", "in the 1990s", "in the 2010s"],
        right=0,
        mistake=(
            "To begin with neural networks. The Stanford Cart drove between chairs in 1979, with a few dozen "
            "points for a map."
        ),
        alts=[
            (
                "Timeline of twelve events from 1979, Moravec's Stanford Cart, to 2017, semantic "
                "factors, in three threads: objects in the map, solvers, and detectors."
            )
        ],
    ),
    argmax=choice(
        "For which box does argmax throw most away?",
        ["the chair, 0.86", "the screen, 0.88", "the cup, 0.47"],
        right=2,
        mistake=(
            "To look at the largest entry and not at what is left of one. All three leave the "
            "detector as one word of the same weight."
        ),
        alts=[
            (
                "A drawn picture of a chair, a screen and a cup in boxes, and bars of the class "
                "posterior of each: chair and screen are sure, the cup has 0.47 against 0.41."
            )
        ],
    ),
    front_end=choice(
        "With names given along the wheels' path, how many objects?",
        ["too many", "too few", "about right"],
        right=0,
        mistake=(
            "To tune the threshold until it is right. One chair seen before and after the drift "
            "stands in two places, and no threshold on distance knows why."
        ),
        alts=[
            "Three bars, all above the line of 15: the more, the higher the threshold.",
        ],
    ),
    in_turns=choice(
        "Will asking again mend what the front end broke?",
        ["yes, here it finds all 15", "only in part", "no, a wrong name stays wrong"],
        right=0,
        mistake=(
            "To think that the second question gets the same answer as the first. The path has moved "
            "in between, and with it every distance."
        ),
        alts=["", "Two maps. Named once: 24 objects, several of them doubled. In turns: 15, each on its own."],
    ),
    rooms=number(
        "In how many of twenty rooms does taking turns find exactly 15?",
        mistake="To say all. And to give the divided way some: it has none.",
        alts=["The objects found in twenty rooms: divided 17 to 38, in turns mostly on the line of 15."],
    ),
    partitions=choice(
        "How many ways are there to group eight sightings?",
        ["28", "256", "more than 4000"],
        right=2,
        mistake=("To count pairs, 28, or subsets, 256. Groupings are partitions, and there are far more of them."),
        alts=[
            "Ways to group one to eight sightings, on a log scale: from 1 to 4140, ever steeper.",
        ],
    ),
    wrong_name=choice(
        "Obj_5 given to chair A: how far is the path bent? And as an object of its own?",
        [
            "centimetres; and as much on its own",
            "decimetres; and as much on its own",
            "decimetres; and not at all on its own",
        ],
        right=2,
        mistake=(
            "To trust that one error among many averages out. In least squares a long spring pulls "
            "hardest. An object of its own pulls on nothing."
        ),
    ),
    both_wrong=choice(
        "Does the front end hesitate? Does χ² notice? Do turns help?",
        [
            "it hesitates; χ² notices; turns help",
            "it does not hesitate; χ² notices; turns do not help",
            "it does not hesitate; χ² is silent; turns help",
        ],
        right=1,
        mistake=(
            "To believe that taking turns mends everything. It starts from the same wheels, and here "
            "it merges even more."
        ),
        alts=[
            "Three bars: near 1 with the true names, far above with both wrong answers.",
        ],
    ),
    weights=choice(
        "With weights 0.3 and 0.7, where does the doubtful sighting pull?",
        ["to the likelier chair alone", "to a point half-way", "towards both, mostly the likelier", "nowhere"],
        right=2,
        mistake="To decide first and pull afterwards. A semantic factor does not decide until it must.",
        alts=[
            (
                "Two factor graphs of three poses and two chairs. Left, the doubtful sighting is tied "
                "to one chair; right, to both, with weights 0.3 and 0.7."
            )
        ],
    ),
)
