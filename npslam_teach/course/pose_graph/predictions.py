"""What ``notebooks/03_pose_graph.ipynb`` asks before it shows a result, and the words for its pictures."""

from npslam_teach.course.predict import choice, questions

predict = questions(
    "03",
    exercises=5,
    lands=choice(
        "Where does the third sighting land, and which way does it pull pose 2?",
        ["on the chair; nowhere", "beyond the chair; back", "beyond the chair; onwards", "before the chair; onwards"],
        right=1,
        mistake=(
            "To mix up who is pulled where. The sighting lies beyond the chair, so the pose must step "
            "back for it to fit."
        ),
        alts=["Map of poses 0, 1, 2 and a chair; the sighting from pose 2 lands beyond it."],
    ),
    turned=choice(
        "Turn left a little: where does what was ahead go, as the robot sees it?",
        [
            "to the left, as much at any distance",
            "to the right, as much at any distance",
            "to the right, the more the further away",
            "to the left, the more the further away",
        ],
        right=2,
        mistake=("To forget that the world turns the other way in the robot's frame, or that an angle has a lever."),
        alts=[
            "After a turn to the left three things that were straight ahead lie to the right, the furthest the most.",
        ],
    ),
    blocks=choice(
        "Between which variables has H no block?",
        ["pose 0 and the chair", "pose 0 and pose 2", "pose 1 and the chair", "it is full"],
        right=1,
        mistake=(
            "To think of what depends on what. H has a block where two variables share a measurement, and nowhere else."
        ),
        alts=["The numbers of H in sixteen blocks; only the two of pose 0 with pose 2 are empty."],
    ),
    gauge=choice(
        "How many of the eleven eigenvalues are zero?",
        ["none", "one", "two", "three"],
        right=3,
        mistake=(
            "To count east and north and to forget turning. The solver does not find where the room "
            "is: nothing measured says so."
        ),
        alts=[
            "The map of three poses and a chair three times, moved east, moved north, and turned, unchanged in itself.",
        ],
    ),
    identity=choice(
        "Adding the identity: is the map right, and the uncertainty?",
        [
            "both are right",
            "the map is right, the uncertainty is wrong",
            "the map is wrong, the uncertainty is right",
            "both are wrong",
        ],
        right=1,
        mistake=(
            "To call it harmless, because the map survives. Every standard deviation read off afterwards is wrong."
        ),
    ),
    worst_order=choice(
        "702 poses, 15 objects: which order is worst?",
        ["objects first", "poses first", "they are alike"],
        right=0,
        mistake=(
            "To eliminate the few before the many. An object ties together all poses that saw it, and "
            "eliminated first it fills whole triangles."
        ),
        alts=["H and its fill in three orders: objects first fills a whole triangle."],
    ),
    iterations=choice(
        "Does Gauss-Newton's χ² fall in every iteration, and do both loops end alike?",
        [
            "it falls; they end alike",
            "it falls; they end apart",
            "it rises now and then; they end alike",
            "it rises now and then; they end apart",
        ],
        right=3,
        mistake=(
            "To expect that a solver which comes to rest has found the lowest point. One of the two "
            "rests in a local minimum, far above."
        ),
        alts=["", "Gauss-Newton climbs twice or thrice and ends far above the loop with damping."],
    ),
    wrong_sign=choice(
        "One sign wrong in one Jacobian: what does Gauss-Newton do?",
        ["it stops with an error", "it runs away", "it looks as if all were well"],
        right=2,
        mistake=(
            "To expect a crash. It gets stuck somewhere plausible; only a comparison with central differences tells."
        ),
    ),
    loop=choice(
        "Once the chairs are seen again, which pose stays least sure?",
        ["pose 3, which slipped", "pose 4", "pose 5, which sees nothing known", "all are alike"],
        right=2,
        mistake=(
            "To look at where the error was made. What counts is what is seen again afterwards: pose "
            "3 is pinned by known chairs, pose 5 only by the wheels."
        ),
        alts=["Ellipses that grow along the path; and small ones once the loop is closed."],
    ),
    time_stamps=choice(
        "Each sighting is one pose late. Is the path ruined, and does χ² notice?",
        [
            "ruined in both drives; noticed in both",
            "not ruined; noticed when the head swings",
            "not ruined; noticed in both",
            "ruined when the head swings; not noticed",
        ],
        right=1,
        mistake=(
            "To expect that χ² hears every fault. In the smooth drive a shift in time looks like "
            "nothing but a shift of the map."
        ),
    ),
)
