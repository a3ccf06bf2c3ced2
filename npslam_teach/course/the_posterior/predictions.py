"""What ``notebooks/11_the_posterior.ipynb`` asks before it shows a result, and the words for its pictures."""

from npslam_teach.course.predict import choice, questions

predict = questions(
    "11",
    exercises=5,
    worlds=choice(
        "In which world does a single object get most?",
        ["α = 0.5", "α = 5", "they are alike"],
        right=0,
        mistake="To read α as the size of objects. A small α breaks large pieces off the stick.",
        alts=["Discs in a room: one or two large ones for alpha 0.5, many small for 5."],
    ),
    order=choice(
        "Do the factors depend on the order? Does the product?",
        ["both do", "the factors do, the product does not", "neither does"],
        right=1,
        mistake="To think that who comes first gets an advantage that lasts.",
    ),
    more=choice(
        "Which has more, and how many hold 95 %?",
        ["{1 3 7 8}; about 4", "{1 3 7 8}; about 400", "{2 4 7 8}; about 4", "{2 4 7 8}; nearly all"],
        right=0,
        mistake="To expect that the true partition wins, or that thousands share the probability.",
        alts=["Map, and bars: {1 3 7 8} 0.576, {1 3} {2 4 7 8} 0.331, the rest small."],
    ),
    where_eight=choice(
        "Where does 8 go when 7 is with A, and when 7 is with B?",
        ["to A both times", "it follows 7", "to the other one", "to a new object"],
        right=1,
        mistake="To decide for 8 alone. Both depend on the same unknown drift.",
        alts=["Bars: with 7 at A, 8 goes to A; with 7 at B, to B; C and new are next to nothing."],
    ),
    extremes=choice(
        "At α = 1000, and at T = 0.1?",
        [
            "eight objects; one partition, the true one",
            "eight objects; one partition, a wrong one",
            "three objects; all partitions alike",
        ],
        right=1,
        mistake="To take the most probable for the truth.",
    ),
    second_chair=choice(
        "How sure is the second chair's place?",
        ["0.316 m", "0.2 m", "0.1 m"],
        right=0,
        mistake="To subtract, or to take the better of the two. Independent errors add by their squares.",
        alts=["Two bell curves along the corridor: narrow at 1.0 m, three times as wide at 1.4 m."],
    ),
    cooling=choice(
        "At which temperature does the number settle?",
        ["near 8", "near 2", "only near 0.05"],
        right=1,
        mistake="To expect that the end of the cooling decides. Large moves are made while it is warm.",
    ),
    room_six=choice(
        "In room 6, how probable are sixteen objects? Does R-hat notice room 8?",
        ["hardly; no", "as probable as fifteen; yes", "as probable as fifteen; no", "certain; yes"],
        right=1,
        mistake="To want one number. It may be fifteen, and it may be sixteen.",
        alts=["Bars: 15 objects are most probable; room 6 gives 16 as much."],
    ),
    chains=choice(
        "After 50 sweeps of single moves: do the chains agree, and R-hat if none moves?",
        ["they agree; 1", "they do not; infinite", "they do not; 1"],
        right=1,
        mistake="To take a calm chain for a converged one.",
        alts=["Running means: apart, but for split and merge."],
    ),
    reliable=choice(
        "Of pairs given less than 0.05, how many are one chair? And with twice the noise?",
        ["next to none; next to none", "next to none; many more than said", "about 5 %; 10 %"],
        right=1,
        mistake=("To think that a probability is true because it was computed properly. It is true if the model is."),
        alts=["Left, points near the diagonal. Right, far above it at the left end."],
    ),
)
