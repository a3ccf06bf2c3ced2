"""What ``notebooks/06_alternation.ipynb`` asks before it shows a result, and the words for its pictures."""

from npslam_teach.course.predict import choice, questions

predict = questions(
    "06",
    exercises=4,
    partners=choice(
        "Obj_8 first, Obj_1 last: which find a partner?",
        ["all of them", "Obj_6 to Obj_1, but not Obj_8 and Obj_7", "Obj_6, Obj_5 and Obj_4 alone", "none"],
        right=1,
        mistake=("To ask for each one alone. Three join a partner, and the partner, asked later, finds them at home."),
    ),
    second_round=choice(
        "What does a second round do in the toy scene?",
        ["it joins more", "it takes a pair apart", "nothing: everybody stays"],
        right=2,
        mistake=(
            "To expect that every round finds something. It does only where the solver has moved the map far "
            "enough: in the big room, not in this small one."
        ),
        alts=[
            "",
            (
                "Two maps of the toy scene. Left, after the sweep: Obj_4 is tied to Obj_1, Obj_5 to Obj_2, "
                "Obj_6 to Obj_3, and the path is still the wheels'. Right, after the solver: each pair has come "
                "together, and the path is nearly the true one."
            ),
        ],
    ),
    falls=choice(
        "By how much does the number fall?",
        ["by log(weight / α)", "by the weight itself", "by α", "it does not fall"],
        right=0,
        mistake=(
            "To expect that the rule and the number are two things. With the same noise on both sides "
            "the rule is one step of descent on this number."
        ),
    ),
    rises=choice(
        "The solver believes 0.5 m: does the number rise now and then?",
        ["yes, in most rooms", "it may, but in these ten rooms it does not", "it cannot"],
        right=1,
        mistake="To take what has not happened for what cannot. With the sensor's own noise it does rise.",
        alts=[
            "The objective of the room with most rises: up in five half-steps that ask who is who, down in between.",
        ],
    ),
    best_of_75=choice(
        "Is the truth the best of 75, and how many of the 24 orders end there?",
        [
            "yes; all",
            "not with the wide noise; half of the orders find the lowest",
            "not with the wide noise; none",
            "yes; half",
        ],
        right=1,
        mistake=(
            "To take the lowest number for the truth. It is the truth only with the right noise, and "
            "which valley is found depends on the order."
        ),
        alts=[("Rankings of all 75 groupings: at 0.35 m all chairs one is best, at 0.05 m the truth is.")],
    ),
    taken_away=choice(
        "The ghost and the cup are taken away: what becomes of the path?",
        ["it gets better", "it stays as it is", "it gets worse"],
        right=1,
        mistake=(
            "To think that a ghost pulls at the path. What was seen once lies where it was seen, wherever "
            "the path is, and pulls at nothing."
        ),
    ),
    own_vote=choice(
        "A sighting's own vote is not taken back: what happens?",
        ["nothing changes", "every sighting keeps to itself", "all merge into one"],
        right=1,
        mistake="To call it a detail. Each sighting is at distance zero from itself, and nothing is nearer.",
    ),
)
