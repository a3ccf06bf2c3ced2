"""What ``notebooks/15_online.ipynb`` asks before it shows a result, and the words for its pictures."""

from npslam_teach.course.predict import choice, questions

predict = questions(
    "15",
    exercises=3,
    middle=choice(
        "The middle pose is eliminated: what is between the other two?",
        ["nothing any more", "a spring half as strong", "a spring twice as strong", "the same spring"],
        right=1,
        mistake=("To strike out what is not asked for. Two springs in a row act as one, weaker than each."),
        alts=["Two matrices: three variables in a chain, and the two that are left, tied by half of the strength."],
    ),
    tree=choice(
        "Eleven stretches are full and a frame arrives: how many submaps are redone?",
        ["all 23", "about a dozen", "two", "none"],
        right=2,
        mistake=(
            "To think that a new pose changes what is behind it. It changes what we believe of the past, but not what "
            "the past's own measurements say."
        ),
        alts=["A binary tree over twelve stretches: the newest one and the top are coloured."],
    ),
    work=choice(
        "How does the number of submaps that a frame redoes change over the drive?",
        ["it grows like the drive", "it grows like the square", "it hardly grows"],
        right=2,
        mistake=(
            "To count how much there is instead of how much has changed. An old object costs its way up the tree, "
            "and a tree twice as large is one level higher."
        ),
        alts=["Dots near the bottom all along the drive, and a dashed line of all submaps that rises far above them."],
    ),
    join=choice(
        "A pass lies 1 m from an old chair: when is it taken for that chair?",
        ["when drift is 0.2 m", "when drift is 1 m", "always", "never"],
        right=1,
        mistake=("To look at the distance alone. One metre is five standard deviations in one case, one in the other."),
        alts=["Three curves that fall with distance: high and steep for little drift, low and flat for much."],
    ),
    revised=choice(
        "Of how many observations does the object change after their frame?",
        ["of none", "of about one in ten", "of more than half"],
        right=1,
        mistake=(
            "To expect all or nothing. Most passes are clear at the first look; where drift is wide some begin as an "
            "object of their own or of a neighbour, and are put right by what is seen next."
        ),
        alts=["A line of the number of objects over the frames: it rises to sixteen and falls to fifteen."],
    ),
    flat=choice(
        "From the second tenth to the last: how does the time of a frame change?",
        ["all grow alike", "of the tree hardly, of solving all anew about fivefold", "of all hardly"],
        right=1,
        mistake="To forget the tree. Solving everything anew, the upper curve, does grow with the drive.",
        alts=["Times over poses so far: those of frames lie low, the tree's flat; those of solving all anew rise."],
    ),
    batch=choice(
        "How far is the path on the way from what a batch would say?",
        ["as far as dead reckoning", "a few percent of the error, more after a loop closes", "not at all"],
        right=1,
        mistake=(
            "To take bounded work for free. What was not linearized anew yet is a little wrong; the end is exact only "
            "once it is finished."
        ),
        alts=["Pose errors over the drive: the robot's own close to the two batch solutions."],
    ),
    eager=choice(
        "What if as many unseen objects are expected as were seen, alpha = 1?",
        ["some objects are never joined again", "objects are merged wrongly", "nothing changes"],
        right=0,
        mistake=("To take a cautious robot for a safe one. What it does not join, it cannot use to correct its drift."),
        alts=["Numbers of objects for two values of alpha; the larger alpha, the more objects in some rooms."],
    ),
    all_methods=choice(
        "At three times the noise, how many of the eight methods are exact in at least half of the rooms?",
        ["none", "two", "four", "all but those that look at one frame alone"],
        right=1,
        mistake=(
            "To take the right number for the right answer. Several methods find fifteen objects at the paper's noise, "
            "but leave sightings out or give them to others."
        ),
        alts=["Marks side by side: the posterior stays near 1, the others fall with the noise; and seconds of a run."],
    ),
)
