"""What ``notebooks/13_soft_association.ipynb`` asks before it shows a result, and the words for its pictures."""

from npslam_teach.course.predict import choice, questions

predict = questions(
    "13",
    exercises=4,
    one_frame=choice(
        "Which observation is of chair 2, and how sure is that?",
        ["observation 1, nearly certain", "observation 1, four in five", "observation 2, four in five", "neither"],
        right=1,
        mistake=(
            "To give each observation its nearest chair, so that chair 1 is seen twice in one frame. "
            "What one observation takes the other cannot have."
        ),
        alts=["Lines from two observations to two chairs: each alone mostly to chair 1; in one frame one to each."],
    ),
    three_and_two=choice(
        "Three say cup and two say book: what is it, and what do votes say?",
        ["a cup, nearly certain; votes: 60 %", "a cup with 60 %; votes: the same", "a book; votes: a cup"],
        right=0,
        mistake=(
            "To count. The detector often calls a cup book and hardly ever a book cup, so that one "
            "report of the second kind outweighs several of the first."
        ),
        alts=["Three curves over five reports: book rises and falls again, cup ends near one."],
    ),
    wrong_report=choice(
        "A gate of three standard deviations: what does a wrong report leave of it?",
        [
            "nothing, whatever the detector",
            "most of it if three of ten are wrong, a quarter if one of a hundred",
            "a half in both cases",
            "a quarter if three of ten are wrong, most of it if one of a hundred",
        ],
        right=1,
        mistake=(
            "To shut the gate to another class, as all lessons so far did. That is right only for a "
            "detector that never errs."
        ),
        alts=["Bars: the gate after a right and after a wrong report, which shrinks as the detector gets better."],
    ),
    side_by_side=choice(
        "Two objects begin side by side between two clusters: where do they go?",
        ["both to the larger cluster", "they stay in the middle", "one to each cluster"],
        right=2,
        mistake=(
            "To expect that what cannot be told apart stays together. The least difference between two "
            "weights grows from round to round."
        ),
        alts=["Two lines over eight rounds: they start close together and part within three rounds."],
    ),
    three_methods=choice(
        "Fifteen objects: how many do NP-graph, the filter, and the filter that knows its detector find?",
        ["about 20, 15 and 15", "more than 60, more than 60, and 15", "more than 60, 15 and 15", "15 each"],
        right=1,
        mistake=(
            "To blame the method. Both take a wrong class for certain; the same filter finds the right "
            "number once reports are worth what they are worth."
        ),
    ),
    half_wrong=choice(
        "Half of the reports are wrong: fifteen objects in how many of thirty rooms?",
        ["in all", "in about 24", "in about ten", "in none"],
        right=1,
        mistake=(
            "To think that half wrong is no better than chance. Wrong reports spread over four other "
            "classes, right ones agree."
        ),
        alts=[
            "",
            "Objects, ARI and pose error for each share of wrong reports: two methods leave fifteen, three stay there.",
        ],
    ),
    em_adds=choice(
        "What does soft association add to the filter's answer?",
        ["the right number where it was wrong", "a better path, as any pose graph would", "both", "nothing"],
        right=1,
        mistake=(
            "To hope that weighing everything again finds what was lost. No weight opens an object, or "
            "joins two that stand apart."
        ),
    ),
    two_chairs=choice(
        "Two chairs 0.3 m apart: which finds the wider gap?",
        ["the mixture of all matchings", "the best matching alone", "they tie"],
        right=1,
        mistake=(
            "To expect no difference. In the mixture each chair gets a share of the other's observations, "
            "which draws the two together; the best alone gives a stray one to the wrong chair in full."
        ),
        alts=["Gaps of twenty runs: those of the mixture mostly below 0.3 m, those of the best alone around it."],
    ),
    too_sure=choice(
        "What does the overconfident detector change most while three of ten reports are wrong?",
        ["the number of objects", "how much is left out", "nothing"],
        right=1,
        mistake=(
            "To look at the number alone. It is nearly as good as before; the contradicting reports "
            "have gone out of the gate, and with them their positions."
        ),
        alts=["Rooms with fifteen objects over the share of wrong reports: both alike up to 30 %, fewer at 50 %."],
    ),
)
