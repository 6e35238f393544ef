"""Arms of a resin as arrays are those of its terms."""

import dataclasses

import numpy as np

from dummydesign.resin import load_resin


def test_times_and_strengths_are_those_of_the_terms_at_each_ratio():
    resin = load_resin("polyurethane-nagoya")
    ratios = resin.ratios()[[0, 3, -1]]
    strengths = resin.strengths(ratios)
    for ratio, row in zip(ratios, strengths):
        terms = resin.prony(float(ratio))
        assert row.tolist() == [term.beta for term in terms] and resin.tau_s == tuple(term.tau_s for term in terms)
    # a softer mixture relaxes more
    assert np.ptp(strengths[:, 0]) > 0.0
    assert dataclasses.replace(resin, arms=()).strengths(ratios).shape == (3, 0)
