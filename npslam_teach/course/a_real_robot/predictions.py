"""What ``notebooks/12_a_real_robot.ipynb`` asks before it shows a result, and the words for its pictures."""

from npslam_teach.course.predict import choice, questions

predict = questions(
    "12",
    exercises=5,
    how_many_poses=choice(
        "How many poses does the log need?",
        ["1200, as many as lines", "about a third of them", "about twenty"],
        right=1,
        mistake="To keep every line. Between two of them nothing has happened that anyone could see.",
        alts=["", "Landmarks in pairs along the walls; the path by the wheels drifts off."],
    ),
    rho=choice(
        "ρ of the simulated camera, and of this one?",
        ["both near 0", "near 0; near 0.8", "near 0.8; near 0", "both near 0.8"],
        right=1,
        mistake="To think that noise has a size, and that is all. It also has a duration.",
        alts=["", "Errors by pass: in the recording every pass has a mean of its own."],
    ),
    twenty_steps=choice(
        "After 20 steps, which is further from the root of 20?",
        ["ahead", "the turn", "both are at it"],
        right=0,
        mistake=("To look at the heading. Here the wheels slip ahead for seconds, and slips of one sign add up."),
        alts=["Growth of errors: recordings rise faster than root n, most of all ahead."],
    ),
    beyond_gate=choice(
        "How many per cent lie beyond the 99 % gate?",
        ["1 % in all", "about 5 % misread, and 1 to 2 % of the rest", "about 20 %"],
        right=1,
        mistake="To count what was misread among the tails. A wrong barcode is another kind of error.",
        alts=["", "Two clouds of errors, nearly all of both inside the gate."],
    ),
    passes=choice(
        "Which does the scatter within passes show?",
        ["0.12 m", "0.06 m", "0.13 m"],
        right=1,
        mistake=(
            "To measure what is easy to measure. Within a pass all sightings share the lasting error, "
            "and it cannot be seen."
        ),
        alts=["A pass in each of eight drives: its sightings lie close together, but beside the bar of the drift."],
    ),
    notices=choice(
        "Which notices noise that lasts?",
        ["χ² per degree of freedom", "NEES", "both", "neither"],
        right=1,
        mistake="To trust a χ² near 1. The fit is good, because errors that last look like another map.",
        alts=["", "chi2 per degree of freedom is at most about 1; NEES over 2 mostly well above."],
    ),
    who_is_best=choice(
        "Of NP-graph, EKF and posterior: who is best at number, partition and path?",
        [
            "NP-graph at all",
            "one method at all three",
            "posterior at the number; EKF and posterior near a tie at the rest",
        ],
        right=2,
        mistake="To look for the best method. It depends on what is asked.",
        alts=[
            "",
            "Objects and path errors by method: EKF and posterior are far ahead.",
            "Four maps beside the truth: NP-graph's scattered, the others on the landmarks.",
        ],
    ),
    alike=choice(
        "How many sightings does NP-graph give to an object that the frame has seen already?",
        ["none", "a handful", "dozens"],
        right=2,
        mistake="To think that no method would do that. The rule asks one sighting at a time.",
    ),
    best_factor=choice(
        "Is the factor that makes χ² per degree of freedom 1 the best one?",
        ["yes", "no, more noise does better", "no, less noise does better"],
        right=1,
        mistake="To scale the noise until χ² is 1. With errors that last this undoes what helps.",
    ),
    data_sheet=choice(
        "Do neighbours merge, or do objects split? Does χ² tell?",
        ["they merge; yes", "they split; yes", "they split; no"],
        right=1,
        mistake=(
            "To expect that splits take all residuals away. Those of the objects that are left do not fit "
            "the small noise either."
        ),
        alts=["Objects and path errors: far off with the data sheet, near 15 with the estimate but for NP-graph."],
    ),
)
