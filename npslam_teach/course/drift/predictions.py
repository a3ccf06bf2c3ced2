"""What ``notebooks/02_drift.ipynb`` asks before it shows a result, and the words for its pictures."""

from npslam_teach.course.predict import choice, questions, sketch

predict = questions(
    "02",
    exercises=5,
    compose=choice(
        "Where is it, and where does it look?",
        [
            "x 0.5 m, y 4 m, looking at −150°",
            "x 1.5 m, y 4 m, looking at 30°",
            "x 3 m, y 2.5 m, looking at 120°",
            "x 0.5 m, y 4 m, looking at 120°",
        ],
        right=0,
        mistake=(
            "To add the step to the pose as it stands, without turning it by the heading first, or to "
            "forget that headings add up."
        ),
    ),
    order=choice(
        "The same two steps in another order: the same end?",
        [
            "the same place and heading",
            "the same heading, another place",
            "the same place, another heading",
            "both differ",
        ],
        right=1,
        mistake=("To swap motions as one swaps numbers. Angles in the plane may be swapped, motions may not."),
        alts=[
            (
                "Map of the same two steps in either order from the origin: drive, then turn ends at "
                "x = 2 m on the x axis; turn, then drive ends at y = 2 m on the y axis. Both look "
                "along y."
            )
        ],
    ),
    toy_path=sketch(
        "The dashed path is the true one. Draw the path that the wheels report.",
        mistake=(
            "To let the error fade away after the slip. Every later pose inherits it in full; nothing "
            "that wheels measure takes it back."
        ),
        box=(-0.6, -0.8, 4.8, 2.8),
    ),
    two_chairs=choice(
        "How far is Obj_5 from Obj_2, the same chair, and from Obj_1, the other one?",
        ["0.0 m and 0.7 m", "0.3 m and 0.4 m", "0.4 m and 0.3 m"],
        right=1,
        mistake=(
            "To expect the same chair at the same place. The slip has moved Obj_5 nearly as close to "
            "the wrong chair as to the right one."
        ),
    ),
    seventy_metres=choice(
        "After 70 m, how far does it end from where it thinks it is?",
        ["2 cm", "20 cm", "about 2 m", "about 20 m"],
        right=2,
        mistake=(
            "To multiply the error of a step by the square root of their number, and forget the "
            "heading, whose lever grows with every metre."
        ),
    ),
    ellipse=choice(
        "How many runs are inside the 95 % ellipse after 5 m, and after 40 m?",
        ["95 % both times", "95 %, then clearly fewer", "fewer, then 95 %"],
        right=1,
        mistake=(
            "To take the covariance for a promise that holds. It is right to first order: an ellipse "
            "cannot bend, the cloud does."
        ),
        alts=[
            (
                "Clouds of 500 ends after 5, 10, 20 and 40 m of straight driving. Near the start they "
                "fill their ellipses; the last bends into a banana that leaves its ellipse."
            )
        ],
    ),
    closed_path=choice(
        "Does the expected error of the position grow all along the path?",
        ["yes, evenly", "yes, faster and faster", "no, it rises in waves"],
        right=2,
        mistake=(
            "To expect growth with every step. Errors swing around the place where a heading went "
            "wrong, and on the way back they shrink."
        ),
        alts=[
            (
                "Distance from the truth along the path in twenty runs, and the prediction, which "
                "rises in waves from 0 to almost 3 m with a dip after each loop."
            )
        ],
    ),
    noticed=choice(
        "How would you notice the wrong order?",
        [
            "the path looks wrong",
            "take the poses apart again: the reports must come back",
            "the last pose is too far away",
        ],
        right=1,
        mistake=("To trust the eye. A wrong path looks like any other drifted path; a round trip has to close."),
    ),
)
