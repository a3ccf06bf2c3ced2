"""Moves of whole objects: split one in two, make one of two.

Where three tracklets of a chair have been taken for another chair, each alone would have to leave its fellows first,
against all odds. Moved together they meet no barrier.
"""

import math

import numpy as np

from npslam_teach.association.gibbs import GibbsSampler
from npslam_teach.association.joint_gaussian import log_normal


def split_or_merge(sampler: GibbsSampler, temperature: float = 1.0) -> bool:
    """Propose to split an object in two, or to make one of two, where single tracklets would have to climb.

    Two tracklets are drawn. If they share an object it is split between them, the others in random order each to
    the one or the other by its weight; if not, their objects are merged, and the probability of the way back is
    that of the same split (Jain and Neal 2004, with sequential allocation: Dahl, "Sequentially-allocated
    merge-split sampler", 2005). Returns whether it was accepted.
    """
    if len(sampler.slot) < 2:
        return False
    anchors = sampler.rng.choice(len(sampler.slot), 2, replace=False)
    if sampler.evidence.rivals[tuple(anchors)]:
        return False
    both = [*{*sampler.members[sampler.slot[anchors[0]]], *sampler.members[sampler.slot[anchors[1]]]}]
    together = sampler.slot[anchors[0]] == sampler.slot[anchors[1]]
    if not together and sampler.evidence.rivals[np.ix_(both, both)].any():
        return False
    others, log_chance = sampler.rng.permutation(sorted(set(both) - set(anchors.tolist()))), None
    if not together:
        log_chance = math.log(sampler.rng.random())
        if log_chance >= sampler.merger_change(*sampler.slot[anchors]) / temperature + 1e-6:
            return False  # the probability of the way back, at most 1, can only lower it
    before = sampler.saved()
    log_way_back = (_split if together else _merge)(sampler, anchors, others, temperature)
    log_ratio = (sampler.log_posterior - before[-1]) / temperature + log_way_back
    if (math.log(sampler.rng.random()) if log_chance is None else log_chance) < log_ratio:
        sampler.refresh()
        return True
    sampler.restore(before)
    return False


def _split(sampler: GibbsSampler, anchors: np.ndarray, others: np.ndarray, temperature: float) -> float:
    """Part an object between two anchors; minus the log probability of this very way, for the way back has one."""
    for tracklet in [*others, *anchors]:
        sampler.split_off(tracklet)
    return -sum(_seat(sampler, tracklet, anchors, None, temperature) for tracklet in others)


def _merge(sampler: GibbsSampler, anchors: np.ndarray, others: np.ndarray, temperature: float) -> float:
    """Make one object of two; the log probability that a split would part it as it was."""
    at_first = {tracklet: sampler.slot[tracklet] == sampler.slot[anchors[0]] for tracklet in others}
    for tracklet in [*others, *anchors]:
        sampler.split_off(tracklet)
    apart = sampler.saved()
    log_way_back = sum(_seat(sampler, tracklet, anchors, at_first[tracklet], temperature) for tracklet in others)
    sampler.restore(apart)
    for tracklet in [*others, anchors[1]]:
        slot = sampler.slot[anchors[0]]
        sampler.join(tracklet, slot, sampler.change_by(tracklet, slot))
    return log_way_back


def _seat(sampler: GibbsSampler, tracklet: int, anchors: np.ndarray, first: bool | None, temperature: float) -> float:
    """Put a lone tracklet to the first of two anchors, to the other, or by chance (None); the log probability."""
    slots = sampler.slot[anchors]
    change = np.array([sampler.change_by(tracklet, slot) for slot in slots])
    scaled = change / temperature
    log_share = scaled - np.logaddexp(*scaled)
    k = int(sampler.rng.random() >= math.exp(log_share[0])) if first is None else int(not first)
    sampler.join(tracklet, slots[k], change[k])
    return float(log_share[k])


def merge_objects(sampler: GibbsSampler) -> None:
    """Merge the two objects whose merger raises the log posterior most, as long as there are such."""
    sampler.refresh()
    while len(sampler.members) > 1:
        change = _merger_changes(sampler)
        gone, stays = np.unravel_index(change.argmax(), change.shape)
        if change[gone, stays] <= 0:
            return
        sampler.merge(int(gone), int(stays))
        sampler.refresh()


def displaced(sampler: GibbsSampler, share: float, spread: np.ndarray) -> np.ndarray:
    """The labels (N,) when small objects turn out to be larger ones, seen in a wrong place.

    A share of the tracklets is displaced: by an error of the pose or of the detector that lasts as long as they do,
    with a covariance far above that of single observations. An object joins the one for which this is most probable
    and more so than that it is there. It does not pull on the map. The most probable joins come first; one that would
    displace more than that share of all observations, and three standard deviations more, is passed over.

    Args:
        sampler: with N tracklets; its partition stays.
        share: of the tracklets that are displaced.
        spread: (2, 2) m^2, by how much.
    """
    labels, change, counts = sampler.slot.copy(), _merger_changes(sampler, spread), sampler.evidence.counts
    size = np.array([counts[members].sum() for members in sampler.members])
    gain = np.maximum(change, change.T) + math.log(share) * np.array([len(each) for each in sampler.members])[:, None]
    # The smaller of two is the guest; of equals, the one that is seen later.
    gain[size[:, None] > size] = -np.inf
    gain[(size[:, None] == size) & np.triu(np.ones(gain.shape, dtype=bool))] = -np.inf
    left = size.sum() * share + 3 * math.sqrt(size.sum() * share)
    while len(gain) and gain.max() > 0:
        guest, host = np.unravel_index(gain.argmax(), gain.shape)
        gain[guest] = -np.inf
        if size[guest] > left:
            continue  # a smaller one may still be within the share
        left -= size[guest]
        # Those that have joined it go along.
        labels[labels == labels[sampler.members[guest][0]]] = labels[sampler.members[host][0]]
    return np.unique(labels, return_inverse=True)[1]


def _merger_changes(sampler: GibbsSampler, spread: np.ndarray | float = 0.0) -> np.ndarray:
    """How the log posterior changes when objects i and j become one, (K, K); -inf for rivals, and for i >= j."""
    count = len(sampler.members)
    member_of = (sampler.slot[:, None] == np.arange(count)).astype(float)
    rivals = member_of.T @ sampler.evidence.rivals @ member_of > 0
    blocks, mean = sampler.joint.cov.reshape(count, 2, count, 2).swapaxes(1, 2), sampler.joint.mean.reshape(-1, 2)
    own = blocks[np.arange(count), np.arange(count)]
    cov = own[:, None] + own - blocks - blocks.swapaxes(2, 3) + spread
    cov[np.arange(count), np.arange(count)] = np.eye(2)
    change = np.where(rivals | np.eye(count, dtype=bool), -np.inf, log_normal(mean[:, None] - mean, cov))
    prior = [sampler.log_prior(tuple(each)) for each in sampler.members]
    # A merger can gain no more than this by the prior: one object less, and every tracklet joins all the others.
    evidence = sampler.evidence
    most = abs(math.log(evidence.alpha / evidence.area)) + len(sampler.slot) * math.log(evidence.counts.sum())
    for i, j in np.argwhere(np.triu(change > -most)):
        joint = sampler.log_prior(tuple(sorted(sampler.members[i] + sampler.members[j])))
        change[i, j] += joint - prior[i] - prior[j]
    change[np.tril_indices(count)] = -np.inf
    return change
