"""What ``notebooks/04_dirichlet_process.ipynb`` asks before it shows a result, and the words for its pictures."""

from npslam_teach.course.predict import choice, questions

predict = questions(
    "04",
    exercises=5,
    fits=choice(
        "Which fits best, and is it much better than the second?",
        ["Obj_2, by far", "Obj_2, with Obj_1 close behind", "Obj_1", "the screen, Obj_6"],
        right=1,
        mistake=(
            "To take the nearest for the only candidate. A Gaussian fades slowly near its middle, and "
            "the rival is the other chair."
        ),
    ),
    new_or_known=choice(
        "With α = 0.5: more likely new, or more likely Obj_2?",
        ["new", "Obj_2"],
        right=1,
        mistake=("To compare α with one, or with the sum of the weights. It is one weight among the others."),
        alts=["Bars: Obj_2 falls from 0.51 to 0.37, Obj_1 from 0.39 to 0.28; new has 0.27."],
    ),
    two_rules=choice(
        "What do the most probable, a threshold of 0.3, and one of 0.5 say?",
        ["Obj_2, Obj_2, new", "Obj_2, new, new", "new, Obj_2, Obj_2", "Obj_2, Obj_2, Obj_2"],
        right=0,
        mistake=(
            "To take both rules for one with another number. A threshold asks for certainty, the "
            "other rule for the best."
        ),
        alts=["The bar of Obj_2, 0.37, is above a threshold of 0.3 and below one of 0.5."],
    ),
    rival=choice(
        "Obj_1 had never been seen: whose answer changes?",
        ["that of the most probable", "that of the threshold", "both", "neither"],
        right=1,
        mistake=(
            "To think that α is a threshold. Without the rival the share of Obj_2 grows, and a bar on "
            "shares minds that; the best stays the best."
        ),
    ),
    tables=choice(
        "After 60 guests with α = 0.9, how many tables?",
        ["about 4", "about 15", "about 54"],
        right=0,
        mistake=(
            "To multiply guests and α. Every guest makes the next new table less likely, so the "
            "number grows with the logarithm."
        ),
        alts=["", "Tables against guests: for each alpha the mean lies on the dashed formula."],
    ),
    alphas=choice(
        "From α = 0.1 to 0.99, and on to 1?",
        ["tenfold; then a little more", "nearly no change; then a cliff", "nearly no change; then nearly none"],
        right=1,
        mistake=(
            "To expect more objects in proportion to α. Only whether α lies below the weight of one vote matters."
        ),
        alts=["Objects found against alpha in four rooms: level up to 0.99, then a cliff."],
    ),
    for_ever=choice(
        "Does the number of objects grow for ever?",
        ["yes, as the restaurant's does", "no, it stops"],
        right=1,
        mistake=(
            "To believe the prior more than the data. The sightings decide, and when there is nothing "
            "new to see the number stops."
        ),
        alts=["Objects against sightings in four rooms: steps up to 15 or 21, then level."],
    ),
)
