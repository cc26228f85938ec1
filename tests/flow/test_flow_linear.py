"""Factors in single precision, and GMRES with them, against dense solutions in double precision."""

import logging

import numpy as np
import pytest
import scipy.sparse as sparse

from plasmapyro.flow import coupled
from plasmapyro.flow.coupled import coupled_solution
from plasmapyro.flow.elements import Space
from plasmapyro.flow.linear import REFINED, ROUGH_LIMIT, Factorised, dissection

SIZE = 60
RTOL = 1e-8  # a residual of 1e-10 times the condition numbers in use


def matrix(kind=float, spread=1.0):
    """A banded matrix without symmetry whose rows differ in size by up to 10^spread."""
    rng = np.random.default_rng(5)
    bands = [
        rng.uniform(-1, 1, SIZE) + (1j * rng.uniform(-1, 1, SIZE) if kind is complex else 0) for _ in range(3)
    ]
    band = sparse.diags([bands[0][1:], bands[1] + 3, bands[2][:-1]], [-1, 0, 1])
    scale = sparse.diags(10.0 ** rng.uniform(-spread, 0, SIZE))
    found = sparse.csr_matrix(scale @ band)
    found.sort_indices()
    return found


def right_hand_side(kind=float):
    rng = np.random.default_rng(6)
    return rng.normal(size=SIZE) + (1j * rng.normal(size=SIZE) if kind is complex else 0)


@pytest.mark.parametrize("kind", [float, complex])
def test_refined_single_precision_is_as_good_as_double(kind):
    a, b = matrix(kind), right_hand_side(kind)
    exact = np.linalg.solve(a.toarray(), b)
    system = Factorised(np.arange(SIZE)).system(a)
    single = system.factors(single=True)
    np.testing.assert_allclose(single.solve(b), exact, rtol=RTOL)
    np.testing.assert_allclose(system.factors().solve(b), exact, rtol=RTOL)
    rough, product = single.solve_roughly(b)
    np.testing.assert_allclose(product, a @ rough, rtol=1e-12)
    error = np.linalg.norm(product - b) / np.linalg.norm(b)
    assert REFINED < error < ROUGH_LIMIT  # single precision it is, and good enough


def test_what_single_precision_cannot_hold_is_factorised_again(caplog):
    # Rows beyond the range of single precision, then a matrix that is singular to its digits.
    b = right_hand_side()
    beyond = matrix() * 1e45
    near = matrix().toarray()
    near[7] = near[8] * (1 + 1e-11)
    near[7, 7] += 1e-9
    for a in (beyond, sparse.csr_matrix(near)):
        system = Factorised(np.arange(SIZE)).system(a)
        for solve in (lambda factors: factors.solve(b), lambda factors: factors.solve_roughly(b)[0]):
            caplog.clear()
            with caplog.at_level(logging.INFO), np.errstate(over="ignore", invalid="ignore"):
                found = solve(system.factors(single=True))
            assert "in double precision after" in caplog.text
            assert np.linalg.norm(a @ found - b) < 1e-6 * np.linalg.norm(b)


def test_rows_that_are_kept_make_up_the_system():
    a, kept = matrix(), np.arange(3, SIZE, 2)
    b = right_hand_side()[kept]
    found = Factorised(kept, kept).solve(a, b)
    np.testing.assert_allclose(found, np.linalg.solve(a.toarray()[np.ix_(kept, kept)], b), rtol=RTOL)


def compact(strength):
    """A matrix of rank three, as smooth couplings nearly are."""
    rng = np.random.default_rng(7)
    return strength * rng.normal(size=(SIZE, 3)) @ rng.normal(size=(3, SIZE))


@pytest.mark.parametrize("tolerance", [1e-2, 1e-9])
def test_gmres_solves_both_parts_to_its_tolerance(tolerance):
    a, rest, b = matrix(), compact(0.2), right_hand_side()
    block = Factorised(np.arange(SIZE)).system(a).factors(single=True).solve_roughly
    calls = []
    found = coupled_solution(block, lambda x: calls.append(x) or rest @ x, b, tolerance)
    whole = a.toarray() + rest
    assert np.linalg.norm(whole @ found - b) <= tolerance * np.linalg.norm(b) * (1 + 1e-6)
    assert len(calls) <= 8  # rank three, and the digits that single precision lacks
    np.testing.assert_array_equal(coupled_solution(block, lambda x: rest @ x, 0 * b, tolerance), 0 * b)


def test_gmres_may_change_its_block_on_the_way():
    a, rest, b = matrix(), compact(0.2), right_hand_side()
    dense, count = a.toarray(), [0]

    def block(y):
        count[0] += 1
        x = np.linalg.solve(dense, y) * (1 + 0.3 * np.cos(np.arange(SIZE) * count[0]))
        return x, dense @ x

    found = coupled_solution(block, lambda x: rest @ x, b, 1e-6)
    assert np.linalg.norm((dense + rest) @ found - b) <= 1.001e-6 * np.linalg.norm(b)


def test_gmres_returns_the_best_of_its_subspace(monkeypatch):
    a, rest, b = matrix(), compact(2.0), right_hand_side()
    block = Factorised(np.arange(SIZE)).system(a).factors().solve_roughly
    whole, left = a.toarray() + rest, []
    for size in (1, 2, 3):
        monkeypatch.setattr(coupled, "LARGEST_SUBSPACE", size)
        found = coupled_solution(block, lambda x: rest @ x, b, 1e-12)
        left.append(np.linalg.norm(whole @ found - b) / np.linalg.norm(b))
    assert 1 > left[0] > left[1] > left[2] > 1e-6
    with pytest.raises(ArithmeticError, match="no finite product in iteration 1"):
        coupled_solution(block, lambda x: x * np.nan, b, 1e-2)


def test_the_load_of_values_is_the_residual_without_slopes(pipe):
    space = Space(pipe(4), (2,))
    part = space.subset(np.arange(3, 20))
    density = np.random.default_rng(8).normal(size=part.r.shape)
    rows = np.zeros((3, *density.shape))
    rows[0] = density
    np.testing.assert_allclose(space.load(part, density), space.residual(part, rows), rtol=1e-12, atol=1e-18)


def test_the_order_of_elimination_separates_the_mesh(pipe):
    # Every vertex and edge once; an edge right before the first of its ends; little fill.
    mesh = pipe(20)
    rank, size = dissection(mesh), mesh.nvertices
    assert sorted(rank) == list(range(size + mesh.nfacets))
    vertices, first = np.sort(rank[:size]), rank[mesh.facets].min(axis=0)
    before = np.append(-1, vertices)[np.searchsorted(vertices, first)]
    assert (rank[size:] < first).all() and (rank[size:] > before).all()
    space = Space(mesh, (2,))
    form = np.zeros((*space.cells.r.shape, 3, 3))
    form[..., 0, 0] = form[..., 1, 1] = form[..., 2, 2] = 1.0
    a = space.matrix(space.gathered(space.cells, space.element_matrices(space.cells, form)))
    by_mesh = Factorised(space.nodes(), rank=rank)
    fill = [each.system(a).factors().fill for each in (by_mesh, Factorised(space.nodes()))]
    in_rows = Factorised(space.nodes(), rank=np.arange(space.size)).system(a).factors().fill
    assert fill[0] < 1.1 * fill[1] < 0.7 * in_rows
    b = np.random.default_rng(9).normal(size=space.size)
    np.testing.assert_allclose(a @ by_mesh.solve(a, b), b, rtol=1e-9, atol=1e-9)
