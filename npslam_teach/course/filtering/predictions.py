"""What ``notebooks/09_filtering.ipynb`` asks before it shows a result, and the words for its pictures."""

from npslam_teach.course.predict import choice, questions

predict = questions(
    "09",
    exercises=5,
    corridor=choice(
        "Nearer to which, and how sure?",
        [
            "the wheels; between the two",
            "the wall; between the two",
            "the wall; surer than either",
            "the middle; surer than either",
        ],
        right=2,
        mistake=("To average the variances. Information adds up, so two measurements are surer than the better one."),
        alts=["", "Bell curves: wide for the wheels, narrow for the wall, narrowest for both."],
    ),
    one_sighting=choice(
        "One sighting of chair A corrects …",
        ["the pose alone", "the pose and chair A", "the pose, chair A and whatever is correlated with them"],
        right=2,
        mistake=(
            "To correct what was looked at. The gain reaches all that shares an error; what was seen "
            "from pose 0 shares none."
        ),
        alts=[
            "",
            "Ellipses before and after: the robot's moves and shrinks, the screen's shifts a little, the chairs' stay.",
        ],
    ),
    gates=choice(
        "What becomes of Obj_5 when both gates are very small?",
        ["it joins the nearer chair", "it is left out", "it is a new object"],
        right=2,
        mistake="To take small gates for careful ones. What lies beyond the second gate of every chair is new.",
    ),
    lie=choice(
        "Does the NIS tell of the lie in both cases?",
        ["in both", "only with everything in use", "only with Obj_5 alone", "in neither"],
        right=1,
        mistake=(
            "To expect that a wrong match always shows. Where no other sighting contradicts it, it fits as "
            "well as a right one."
        ),
        alts=[
            "",
            "Four cases: told chair A the robot is off by far more than the bar of what the filter promises.",
        ],
    ),
    graph_says=choice(
        "What does the graph say to chair A, chair B and new?",
        ["A fits best", "B and new fit alike, A does not", "all three fit", "new fits best by far"],
        right=1,
        mistake=("To expect that χ² prefers the truth to a new object. It cannot; only the price of an object does."),
        alts=[
            "",
            "Three bars: chair A is the highest by far, chair B and new are nearly alike.",
        ],
    ),
    circle=choice(
        "Where does plain subtraction go wrong, and by how much?",
        ["at 0°, by 360°", "at 180°, by 360°", "everywhere, by a little"],
        right=1,
        mistake="To look at zero. Headings jump at half a turn.",
        alts=[
            "",
            "The NIS stays low when wrapped; plain, it jumps into the thousands beyond 180 degrees.",
        ],
    ),
    half_noise=choice(
        "It believes half the true noise: how large is the average NIS?",
        ["half of what is expected", "twice", "four times", "the same"],
        right=2,
        mistake="To forget the square.",
        alts=["NIS along the path: in the band around 1 only for the noise as it is."],
    ),
    order_of_errors=choice(
        "Order of the pose errors, in the median?",
        ["EKF, NP-graph, graph after the EKF", "the graphs alike, then the EKF", "NP-graph, EKF, graph after the EKF"],
        right=1,
        mistake=("To say that graphs always beat filters. The filter is better at who is who, the graph at where."),
        alts=["Mean pose errors: least for the graph after the EKF, with the least spread."],
    ),
)
