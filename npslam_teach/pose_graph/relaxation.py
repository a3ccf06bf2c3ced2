"""A start from all measurements at once: chi2 as a quadratic of complex numbers, headings let off the unit circle.

Unlike the chordal start it takes its headings from positions and observations too, so that it also serves where
landmarks close the loops. It needs isotropic weights, which are put in place of those of the measurements; the weights
of the headings' errors are those of the chordal distance (Rosen et al., "SE-Sync", IJRR 2019).
"""

from dataclasses import replace

import numpy as np

from npslam_teach.pose_graph.complex_form import Layout, QuadraticForm, as_complex, isotropic_part, layout_of
from npslam_teach.pose_graph.factor_kinds import FACTOR_KINDS
from npslam_teach.pose_graph.factorization import SINGULAR, solve_once
from npslam_teach.pose_graph.object_headings import faced_from
from npslam_teach.pose_graph.unknowns import within_bounds
from npslam_teach.types import PoseGraph


def relaxed_start(graph: PoseGraph) -> PoseGraph:
    """The graph moved to the minimum of the relaxed problem; what is fixed stays where it is.

    Args:
        graph: of whose estimate only what is fixed is used. Headings of landmarks follow from the poses it finds.

    Raises:
        numpy.linalg.LinAlgError: where isotropic weights do not determine every pose and landmark.
    """
    layout = layout_of(graph)
    matrix = _relaxed_form(graph, layout).matrix(len(layout.y))
    # The heading of the whole map is given: it is what the fixed poses and landmarks say.
    rest = solve_once(matrix[1:, 1:], -matrix[1:, [0]].toarray().ravel())
    y = np.append(1.0, rest)
    headings, positions = layout.headings["poses"].values(y), layout.positions["poses"].values(y)
    landmarks = layout.positions["landmarks"].values(y)
    if not within_bounds(np.append(positions, landmarks)):
        raise np.linalg.LinAlgError(SINGULAR)
    poses = np.column_stack([positions.real, positions.imag, np.angle(headings)])
    poses[graph.fixed_poses] = graph.poses[graph.fixed_poses]
    landmarks = np.column_stack([landmarks.real, landmarks.imag])
    landmarks[graph.fixed_landmarks] = graph.landmark_xy[graph.fixed_landmarks]
    return replace(graph, poses=poses, landmarks=faced_from(graph, poses, landmarks))


def _relaxed_form(graph: PoseGraph, layout: Layout) -> QuadraticForm:
    """chi2 of the relaxed problem as a quadratic form."""
    form = QuadraticForm()
    for kind in (kind for kind in FACTOR_KINDS if kind.displaces):
        a, b = kind.ends(graph)
        weight, heading_weight = isotropic_part(kind.information(graph))
        measured = getattr(getattr(graph, kind.name), kind.measured[0])
        z_a = layout.heading(a)
        form.add_displacement(layout, (a, b), weight, -weight * as_complex(measured))
        form.add(z_a, z_a, weight * np.abs(as_complex(measured)) ** 2 / 2)
        if b.variable in layout.headings:
            z_b = layout.heading(b)
            form.add(z_a, z_b, -heading_weight * np.exp(-1j * measured[:, 2]))
            form.add(z_a, z_a, heading_weight / 2)
            form.add(z_b, z_b, heading_weight / 2)
    return form
