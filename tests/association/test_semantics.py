"""Classes that a detector confuses: Bayes' rule by hand, and the rule of equal classes as its limit."""

import numpy as np
import pytest

from npslam_teach.association import semantics


def random_rows(rng, count, num_classes):
    return rng.dirichlet(np.ones(num_classes), count)


def test_reports_through_a_confusion_matrix_by_hand():
    """Of chairs 0.9 are called chair, of cups 0.4: a report "chair" is of a chair with 0.9 / (0.9 + 0.4)."""
    confusion = np.array([[0.9, 0.1], [0.4, 0.6]])
    np.testing.assert_allclose(semantics.reported([0, 1], confusion), [[9 / 13, 4 / 13], [1 / 7, 6 / 7]])


def test_an_evenly_confused_detector_is_wrong_in_its_share():
    confusion = semantics.evenly_confused(5, 0.3)
    np.testing.assert_allclose(confusion.sum(axis=1), 1.0)
    np.testing.assert_allclose(np.diag(confusion), 0.7)
    np.testing.assert_allclose(confusion[~np.eye(5, dtype=bool)], 0.3 / 4)
    np.testing.assert_array_equal(semantics.evenly_confused(1, 0.0), [[1.0]])


@pytest.mark.parametrize(("classes", "share"), [(5, -0.1), (5, 1.1), (1, 0.5), (5, np.nan)])
def test_a_share_that_is_none(classes, share):
    with pytest.raises(ValueError, match="share: expected"):
        semantics.evenly_confused(classes, share)


@pytest.mark.parametrize("confusion", [[[0.5, 0.4], [0.5, 0.5]], [[1.5, -0.5], [0.5, 0.5]]])
def test_rows_that_are_no_distributions(confusion):
    with pytest.raises(ValueError, match="confusion: expected rows"):
        semantics.reported([0], np.array(confusion))


def test_a_report_that_no_class_gives():
    with pytest.raises(ValueError, match="confusion: .* reported as 1"):
        semantics.reported([0, 1], np.array([[1.0, 0.0], [1.0, 0.0]]))


def test_certain_reports_are_the_rule_of_equal_classes():
    obs_class, object_class = np.array([0, 1, 2, 1]), np.array([1, 1, 0])
    seen, of_objects = (semantics.log_likelihoods(own, 3, None) for own in (obs_class, object_class))
    belief = semantics.updated_belief(np.zeros((3, 3)), of_objects)
    distance = semantics.class_distances(seen, belief)
    np.testing.assert_array_equal(distance == 0.0, obs_class[:, None] == object_class)
    np.testing.assert_array_equal(np.isinf(distance), obs_class[:, None] != object_class)


def test_a_report_of_nothing_and_a_single_report_are_no_evidence():
    seen = semantics.log_likelihoods([0] * 6, 4, random_rows(np.random.default_rng(3), 6, 4))
    for each in (*seen, np.zeros(4)):
        assert semantics.class_evidence(each) == pytest.approx(0.0, abs=1e-12)
    both = semantics.log_likelihoods([0, 1], 4, None).sum(axis=0)
    assert semantics.class_evidence(both) == -np.inf, "certain reports of two classes are of no object"


def test_distances_are_bayes_factors_against_nothing():
    """Over all true classes: p(report | object) / p(report | nothing), in the simplest words."""
    rng = np.random.default_rng(4)
    likelihood, belief = random_rows(rng, 6, 4), random_rows(rng, 3, 4)
    found = semantics.class_distances(semantics.log_likelihoods([0] * 6, 4, likelihood), np.log(belief))
    for k in range(6):
        for j in range(3):
            of_object = sum(belief[j, c] * likelihood[k, c] for c in range(4))
            of_nothing = sum(likelihood[k, c] / 4 for c in range(4))
            assert found[k, j] == pytest.approx(-2 * np.log(of_object / of_nothing))


def test_beliefs_are_products_in_any_order():
    rng = np.random.default_rng(5)
    likelihood = random_rows(rng, 7, 4)
    seen = semantics.log_likelihoods([0] * 7, 4, likelihood)
    expected = likelihood.prod(axis=0) / likelihood.prod(axis=0).sum()
    for order in (range(7), reversed(range(7)), rng.permutation(7)):
        belief = np.zeros((1, 4))
        for k in order:
            belief = semantics.updated_belief(belief, seen[k : k + 1])
        np.testing.assert_allclose(np.exp(belief[0]), expected)


def test_a_contradiction_is_said():
    chair, cup = semantics.log_likelihoods([0, 1], 2, None)
    belief = semantics.updated_belief(np.zeros((1, 2)), chair[None])
    with pytest.raises(ValueError, match="seen: .*contradicts"):
        semantics.updated_belief(belief, cup[None])
