"""What ``notebooks/draw_your_own_world.ipynb`` asks before it shows a result, and the words for its pictures."""

from npslam_teach.course.predict import choice, questions, sketch

predict = questions(
    "draw",
    exactly_fifteen=choice(
        "Does the method end with exactly fifteen objects?",
        ["yes", "no, with more", "no, with fewer"],
        right=0,
        mistake="To expect that a hand-drawn figure of eight is harder than the designed path.",
        alts=[
            "",
            (
                "Six maps of a room, one for each round: first a thousand sightings in clouds along a "
                "drifted figure of eight, at last one marker on each of 15 true objects and a path on "
                "the true path."
            ),
        ],
    ),
    tremor=choice(
        "By how much does the raw line turn from point to point?",
        ["about 1°", "about 10°", "about 80°"],
        right=2,
        mistake="To compare 2 cm with 5 m. The points are 2 cm apart.",
        alts=[
            "A line that trembles by centimetres, and the averaged one, nearly straight.",
            (
                "Headings along the line: those of the drawn line jump up and down by 80 degrees and more, that "
                "of the robot stays within ten degrees of zero."
            ),
        ],
    ),
    twins=choice(
        "Sixteen are there: how many are found, and does the path suffer?",
        ["16; no", "15; hardly", "15; badly", "17; no"],
        right=1,
        mistake=("To expect harm from every wrong merger. Both chairs stay where they are, half a metre apart."),
        alts=[
            (
                "Two maps of the room. Left, two hollow true chairs right of the middle share one filled chair; "
                "right, where the second chair is a lamp, each hollow marker has its own filled one."
            )
        ],
    ),
    gap=choice(
        "At which gap do the two come apart?",
        ["0.6 m", "1 m", "1.8 m", "never"],
        right=1,
        mistake=("To compare the gap with the kernel alone. The more often a chair was seen, the further it reaches."),
        alts=[
            (
                "Columns of dots for four gaps. At 0.6 m all runs are one below the dashed line of 16; at 1 m they "
                "scatter from 15 to 22; at 1.4 and 1.8 m all but one of each lie on the line."
            )
        ],
    ),
    corridor=sketch(
        "The dashed path is the true one. Draw the path that is found, from its start.",
        mistake=(
            "To fear for the count. Every object is found once; but nothing is seen again, and so "
            "nothing straightens the path."
        ),
        box=(0, 0, 36, 9),
        alts=[
            (
                "A corridor of 36 m. Above, each of 16 objects is found once, and the estimated path is an "
                "arch beside the straight true path; in the middle, with a turn half-way, it lies on the "
                "true one; below, the arch stretched sideways, higher in the middle than at both ends."
            )
        ],
    ),
    one_class=choice(
        "All of one class: more than fifteen found, or fewer?",
        ["more", "fewer", "fifteen"],
        right=0,
        mistake="To expect that all merge. What lands between the chairs stays in pieces.",
        alts=[
            (
                "Two maps. Left, chairs only: more filled circles than hollow ones, and an estimated path "
                "that is off the true one by up to metres; right, five classes, and nearly all is in place."
            )
        ],
    ),
    moving=choice(
        "How many screens will stand along its way?",
        ["none", "one, in the middle", "several"],
        right=2,
        mistake="To expect an average. Each visit finds it somewhere else and opens a new object.",
        alts=[
            (
                "Two maps. Left, filled squares in a row down the middle, where one screen was "
                "wheeled, and a path pulled off the true one beside them; right, nothing moves, and each is found once."
            )
        ],
    ),
    ghosts=choice(
        "Will the vote take the ghosts away?",
        ["yes", "no, a draw stays"],
        right=1,
        mistake=("To take the false-positive vote for a detector of ghosts. One vote for and one against is a draw."),
        alts=[
            (
                "Two maps. Left, 15 objects where they are, and dozens of small pale markers all over the room; "
                "right, the 15 alone."
            )
        ],
    ),
    alarms=choice(
        "Which gives itself away by nothing at all?",
        ["the twins", "the corridor", "the ghosts", "the moving screen"],
        right=1,
        mistake=(
            "To trust that something would show. Drift without return leaves no trace in the robot's own numbers."
        ),
        alts=[
            (
                "One row a world. Left, chi2: the twins all beyond the dashed alarm, the corridor and the world "
                "without defect below it; right, dozens of objects seen once with the false detector alone."
            )
        ],
    ),
)
