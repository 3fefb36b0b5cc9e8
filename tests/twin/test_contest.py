"""Which fault explains it, by closed forms: residuals drawn at random, linear in the size of a fault."""

import math

import numpy as np
import pytest

from twin.estimation.contest import INDEPENDENT, Link, rank

SCANS = 400


def ranked(true: float, shots: int, rng: np.random.Generator, wild: float = 0.0):
    """Of a rig with a fault `a`, beside twins with `a` and `b`; a share of the shots is wild, for all twins alike."""
    links = [Link("a", (0, 1), (0.0, 1.0)), Link("a", (1, 2), (1.0, 2.0)), Link("b", (0, 3), (0.0, 1.0))]
    squares, products = [], []
    for _ in range(shots):
        a, b, noise = rng.normal(size=(3, SCANS))
        noise = noise * (40.0 if rng.uniform() < wild else 1.0)
        r = np.array([noise + 3.0 * true * a, noise + 3.0 * (true - 1.0) * a, noise + 3.0 * (true - 2.0) * a,
                      noise + 3.0 * true * a - 3.0 * b])  # fmt: skip
        squares.append((r * r).mean(axis=1))
        products.append([(r[i] * r[j]).mean() for i, j in (link.rows for link in links)])
    return rank(links, np.array(squares), np.array(products)), np.array(squares)


def test_the_size_is_found_between_those_that_run():
    """Of 1.3 between 1 and 2: within three deviations, which is that of least squares, 1/(3 sqrt(N)), and a place."""
    found, _ = ranked(1.3, 12, np.random.default_rng(1))
    size, deviation = found.sizes["a"]
    assert next(iter(found.behind)) == "a"
    assert size == pytest.approx(1.3, abs=3.0 / (3.0 * math.sqrt(12 * SCANS)) + 1.0 / 64.0)
    assert deviation < 0.1


def test_what_is_proportional_to_a_factor_is_found_between_far_sizes():
    """Residuals linear in a leak that is ten times as large, beside twins of e^2 and e^4: within a place."""
    rng, sizes = np.random.default_rng(4), np.array([0.0, 2.0, 4.0])
    links = [Link("leak", (k, k + 1), (sizes[k], sizes[k + 1]), factor=True) for k in range(2)]
    shape, noise = rng.normal(size=(2, 6, SCANS))
    r = noise + (10.0 - np.exp(sizes))[:, None, None] * shape
    products = [(r[k] * r[k + 1]).mean(axis=1) for k in range(2)]
    found = rank(links, (r * r).mean(axis=2).T, np.array(products).T)
    assert found.sizes["leak"][0] == pytest.approx(math.log(10.0), abs=2.0 / 64.0)


def test_likelihoods_are_those_of_the_stated_law():
    """Of the baseline and of the first, by hand."""
    found, squares = ranked(1.0, 6, np.random.default_rng(2))
    own = [-0.5 * INDEPENDENT * float(np.log1p(squares[:, row]).sum()) for row in (0, 1)]
    assert found.nothing == pytest.approx(own[1] - own[0], rel=0.02)
    assert found.behind["a"] == 0.0
    assert found.behind["b"] > found.nothing - 1.0  # what it would change is not what is there


def test_nothing_is_named_of_a_rig_in_order():
    found, _ = ranked(0.0, 16, np.random.default_rng(3))
    assert found.nothing < math.log(100.0)


def test_no_single_shot_decides():
    """A third of the shots is forty times as wild: by sums of squares they alone would choose."""
    names = [next(iter(ranked(1.0, 9, np.random.default_rng(10 + k), 0.33)[0].behind)) for k in range(20)]
    assert names.count("a") == 20
