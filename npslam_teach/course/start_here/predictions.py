"""What ``notebooks/00_start_here.ipynb`` asks before it shows a result, and the words for its pictures."""

from npslam_teach.course.predict import choice, number, questions

predict = questions(
    "00",
    first_round=choice(
        "How many objects after one round?",
        ["about 500", "about 50", "exactly the right number"],
        right=1,
        mistake=(
            "To expect the right number at once, or a slow shrinking by half. One round already joins "
            "nearly all that can be joined along the wheels' path; the rest needs the path to move "
            "first."
        ),
        alts=[
            "",
            (
                "Animated map: clouds of sightings around each object shrink, round by round, to 15 single "
                "objects while the estimated path moves onto the true path."
            ),
        ],
    ),
    carried=choice(
        "Where in the room is what is 3 m ahead and 1 m to the left?",
        ["(4, 3)", "(0, 5)", "(2, 5)", "(3, 1)"],
        right=1,
        mistake=(
            "To add without turning, which gives (4, 3), or to turn the wrong way round, which gives "
            "(2, 5). Looking along y, ahead is y, and left is minus x."
        ),
        alts=[
            "A robot that looks up: three metres up, then one to the left, end at the sighting.",
        ],
    ),
    drift=choice(
        "How far off are the poses, on average over 700 steps?",
        ["centimetres", "decimetres to metres", "tens of metres"],
        right=1,
        mistake=(
            "To think that small errors stay small or cancel. An error of heading turns all that "
            "comes after it, and so it grows with every metre driven."
        ),
        alts=[
            (
                "Map of the dead-reckoned path, which ends more than a metre from where it should, "
                "and over a thousand sightings in clouds beside the 15 true objects, some objects "
                "with two clouds."
            )
        ],
    ),
    twenty_rooms=number(
        "In how many of twenty rooms will it find exactly 15?",
        mistake="To say twenty after one success. One good room proves nothing.",
        alts=[
            "A dot for each of twenty rooms: most on the line of 15, the others above it.",
        ],
    ),
    cliff=choice(
        "What happens at α = 1.0?",
        ["one or two objects more", "about twice as many", "every sighting becomes an object", "fewer objects"],
        right=2,
        mistake=(
            "To expect a little more of the result for a little more of the setting. There is a "
            "cliff, and 0.9 stands near its edge."
        ),
        alts=[
            "Three bars: 15 objects for alpha 0.5 and for 0.9, 1185 for 1.0.",
        ],
    ),
)
