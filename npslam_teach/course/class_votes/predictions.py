"""What ``notebooks/05_class_votes.ipynb`` asks before it shows a result, and the words for its pictures."""

from npslam_teach.course.predict import choice, questions

predict = questions(
    "05",
    exercises=5,
    two_classes=choice(
        "Which objects have votes for more than one class?",
        ["the screen", "both chairs", "none"],
        right=2,
        mistake=(
            "To expect a mixture. A sighting never joins an object that has no vote for its class, so "
            "votes for two classes cannot arise."
        ),
        alts=["Stacked votes of five objects, each with one class and one vote for nothing."],
    ),
    doubt=choice(
        "The screen, seen twice: its share, and the doubt left?",
        ["1 and 0", "0.667 and 0.333", "0.5 and 0.5"],
        right=1,
        mistake="To forget the one vote for nothing there. Two sightings against it leave a third.",
        alts=["beta_3: before, 2 votes for screen; after, also 1 for nothing there."],
    ),
    epsilon=choice(
        "With ε = 0.4, what goes?",
        ["the false detection alone", "what was seen once: Obj_8 and the real cup, Obj_7", "nothing", "everything"],
        right=1,
        mistake=("To expect that the vote finds ghosts. It counts sightings, and a real cup seen once goes too."),
    ),
    highest=choice(
        "Where on the triangle is the density highest?",
        ["inside", "on an edge", "at a corner"],
        right=1,
        mistake=(
            "To put it at the mean, which is inside. With prior 1 the mode is the shares themselves, "
            "and one of them is zero."
        ),
    ),
    agree=choice(
        "With prior 1, which two agree, and which never says zero?",
        ["mean and mode; maximum likelihood", "mode and maximum likelihood; the mean", "all three; none"],
        right=1,
        mistake=(
            "To take all three for the same thing. The mean adds the prior to every class, so it never rules one out."
        ),
        alts=[
            "",
            "Against the prior: the mean is never zero; the mode is zero at a prior of 1 and does not exist below.",
        ],
    ),
    misread=choice(
        "The detector reads one chair as a screen: how many objects, and where?",
        ["5, one with a wrong label", "6, two of them at one place", "4"],
        right=1,
        mistake=(
            "To expect only a wrong label. The sighting finds no object with a vote for its class, "
            "and opens a second one at the same place."
        ),
    ),
    fifteen=choice(
        "Fifteen things, confused three times in ten: how many are found?",
        ["about 15", "about 20", "about twice too many", "hundreds"],
        right=2,
        mistake=("To think that the majority of votes corrects errors. The errors never vote on the same object."),
        alts=["Map: in most rings of true chairs and screens lie two marks, a chair on a screen."],
    ),
    one_each=choice(
        "One sighting of each: the probabilities? And after 20 and 10?",
        ["a tie; then two to one", "a tie; then nearly certain", "nearly certain both times"],
        right=1,
        mistake=(
            "To read shares as probabilities. Twenty reports against ten are strong evidence when the errors are known."
        ),
        alts=["", "Objects found in eight rooms: hard votes about 32, soft votes about 18."],
    ),
    no_good=choice(
        "How much does a vote for the right class now weigh at distance zero?",
        ["1", "about 0.6", "0"],
        right=1,
        mistake=(
            "To keep α where it was. A vote now weighs the chance of the next report, and 0.9 is "
            "beyond that: the cliff again."
        ),
    ),
)
