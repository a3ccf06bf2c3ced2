"""What ``notebooks/14_orientation.ipynb`` asks before it shows a result, and the words for its pictures."""

from npslam_teach.course.predict import choice, questions

predict = questions(
    "14",
    exercises=4,
    one_cloud=choice(
        "Two chairs 0.25 m apart, a camera that errs by 0.15 m: what do their sightings look like?",
        ["two clouds with a gap between them", "one cloud", "two clouds that touch"],
        right=1,
        mistake=(
            "To compare the distance with one error. Two clouds show a gap only where they are about four "
            "standard deviations apart; these are less than two."
        ),
        alts=["One cloud of points; with headings the points fall into two groups that face opposite ways."],
    ),
    looks_alike=choice(
        "A table is turned by 170 degrees. How far from where it was is it, as far as anybody can see?",
        ["170 degrees", "10 degrees, the other way", "10 degrees, the same way", "80 degrees"],
        right=1,
        mistake=(
            "To wrap to half a turn either way, as for a robot's own heading. A table turned by 180 degrees is "
            "the same table, so that 170 is 10 too few."
        ),
        alts=["Saw teeth over the turn: one for a chair, two for a table, four for a square, a flat line for a cup."],
    ),
    nearer_or_turned=choice(
        "Chair A is nearer, chair B faces as was seen: whose weight is larger?",
        ["A's, with or without the heading", "A's without, B's with it", "B's, with or without"],
        right=1,
        mistake=(
            "To think that place comes first. Both are errors in standard deviations, and half a turn is nine of them."
        ),
        alts=["Bars: by position alone chair A weighs more, with the heading chair B does and A nothing."],
    ),
    mean_of_two=choice(
        "A table is reported at 85, -88, 94 and -97 degrees. What is its mean heading?",
        ["-1.5 degrees, the mean of the numbers", "about 88 degrees", "it has none"],
        right=1,
        mistake=(
            "To average the numbers. All four are within ten degrees of one line, and half a turn of a table is "
            "no turn."
        ),
        alts=["Four marks on a circle, at the top and at the bottom; one mean points right, the other one up."],
    ),
    gate=choice(
        "Of sightings of one chair, how many are nearer to it than to the other, by position and heading?",
        ["as many as by position", "a few more than by position, not all", "all"],
        right=2,
        mistake=(
            "To expect a compromise between the two. Squared distances add up, and a turn by half is so far out "
            "that no error of position makes up for it."
        ),
        alts=["Two scatter plots of squared distances: on the left around the diagonal, on the right all above it."],
    ),
    three_methods=choice(
        "Eight chairs: what do NP-graph and the filter find without headings?",
        ["8 and 8, as it should be", "4 or 5, both", "8, and 4 or 5", "16, both"],
        right=2,
        mistake=(
            "To take the right number for the right answer. NP-graph is told that a frame shows no chair twice, "
            "so it finds two at each place, and deals the sightings out between them as it happens."
        ),
    ),
    how_bad=choice(
        "How bad may a heading be before NP-graph has lost half of what it gained?",
        ["5 degrees", "20 degrees", "45 to 60 degrees", "it never does"],
        right=2,
        mistake=(
            "To ask for good headings. Two fronts are 180 degrees apart, and what counts is how many errors "
            "that is: three or four still do."
        ),
        alts=["ARI over the error of a heading: near one up to 30 degrees, back to what it is without at 90."],
    ),
    two_in_one=choice(
        "How many tracklets hold sightings of two chairs: without headings, at 10 degrees, at 45?",
        [
            "hardly any in all three",
            "nearly all; none; about half",
            "about half; none; none",
            "none; about half; nearly all",
        ],
        right=1,
        mistake=(
            "To think that half a turn is always out of reach. At 45 degrees it is four errors of one heading, but "
            "less than three of the difference between two."
        ),
    ),
    compass=choice(
        "Told who is who, how much better is the path with headings that err by 10 degrees?",
        ["ten times", "half the error is gone", "hardly", "it gets worse"],
        right=2,
        mistake=(
            "To take a chair for a compass. A heading of 10 degrees says less of the robot's own than the place of the "
            "chair in the picture does: 0.15 m at a distance of 3 m are three degrees."
        ),
        alts=["Mean pose error over the error of a heading: lower at two degrees, else nearly level."],
    ),
    two_fronts=choice(
        "Chairs look alike from front and back, and the log does not say so. What does NP-graph find?",
        ["8 objects, as before", "about 16: each chair once for either front", "4", "an error message"],
        right=1,
        mistake=(
            "To expect an error. The kernel does what it was told: what faces the other way is another object, "
            "at the same place."
        ),
        alts=["Two maps: on the left every chair has two noses that point opposite ways, on the right one."],
    ),
)
