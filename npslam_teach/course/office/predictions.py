"""What ``notebooks/08_office.ipynb`` asks before it shows a result, and the words for its pictures."""

from npslam_teach.course.predict import choice, questions

predict = questions(
    "08",
    exercises=5,
    mean_of_box=choice(
        "Does the mean of all pixels in the box lie on the chair?",
        ["yes", "no, in front of it", "no, behind it"],
        right=2,
        mistake=(
            "To take the centre of the box for the object. Floor, desk and wall behind the chair pull the mean away."
        ),
    ),
    which_boxes=choice(
        "In which boxes is the mean worse?",
        ["in all", "only where the depths scatter", "in none"],
        right=1,
        mistake="To blame the mean as such. Where all pixels are of the object every rule agrees.",
        alts=[
            "",
            "Error against the scatter of depths: the mean begins lowest and ends highest.",
        ],
    ),
    two_screens=choice(
        "Two screens 0.7 m apart: are they kept apart?",
        ["always", "often not"],
        right=1,
        mistake="To compare 0.7 m with the error of the camera. The kernel and the drift are wider.",
        alts=[
            "",
            "Map of the screens: of some pairs of squares all sightings have one colour and marker.",
        ],
    ),
    each_one=choice(
        "About as many as there are: is each of them one real object?",
        ["yes", "no: mergers and pieces cancel in the count"],
        right=1,
        mistake="To take the right number for the right objects.",
    ),
    strict=choice(
        "At ε = 0.02, how many of the NP-graph's 110 objects stay valid?",
        ["about 40", "about 20", "about 5", "none"],
        right=2,
        mistake=(
            "To think of the real objects. What counts is how often each was seen: half of them 29 times "
            "or less, and the limit is 49."
        ),
    ),
)
