"""A first guess is near the states it was made of, where they hold, and is none elsewhere."""

import hashlib
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
import yaml

from plasmapyro.flow import guess, levels, stage
from plasmapyro.flow.condition import Condition
from plasmapyro.flow.continuation import NotConverged
from plasmapyro.flow.dataset import Setup
from plasmapyro.flow.geometry import Torch, build_mesh
from plasmapyro.quantities import in_si

ROOT = Path(__file__).resolve().parents[2]
POWER = np.arange(50e3, 131e3, 10e3)
AIR = SimpleNamespace(attrs={})
HERE = Condition(90e3, 5e3, 0.016, 4e5, 350.0)
NODES, VERTICES = 7, 3
SIZE = 3 * NODES + VERTICES


@pytest.fixture
def setup(torch_lengths):
    return Setup(Torch(**torch_lengths), 350.0, 1.0)


@pytest.fixture
def states():
    """Function power -> state: a cubic in the power, which the interpolation holds exactly."""
    terms = np.random.default_rng(1).normal(size=(4, SIZE))
    return lambda power: sum(term * (power / 1e5 - 0.9) ** order for order, term in enumerate(terms))


@pytest.fixture
def problem(setup, states, monkeypatch):
    vertices = np.array([[0.0, 0.1, 0.2], [0.0, 0.01, 0.0]])
    said = guess.told(setup, AIR, HERE)
    known = np.array([states(power) for power in POWER])
    kept = guess.gathered(POWER, [known, known[:, :4]], said, [vertices, vertices[:, :1]])
    monkeypatch.setattr(guess, "arrays", lambda name: kept)
    fixed = np.arange(SIZE) == 2
    space, mesh = SimpleNamespace(size=SIZE), SimpleNamespace(p=vertices)
    return SimpleNamespace(mesh=mesh, space=space, fixed=fixed, values=np.full(SIZE, 5.0))


@pytest.mark.parametrize("power", [50e3, 64e3, 90e3, 127e3, 130e3])
def test_a_guess_is_the_state_to_some_quanta_also_between_the_powers(setup, states, problem, power):
    found = guess.guessed(problem, setup, AIR, replace(HERE, numerical_power=power))
    assert found[2] == 5.0  # the boundary values are those of the problem
    free = ~problem.fixed
    off = np.abs(found - states(power)) / guess._quantum(SIZE, VERTICES)
    assert off[free].max() < 4.0  # each of nine modes is off by half a quantum times an amplitude below one


def test_another_mesh_gas_power_or_condition_has_no_guess(setup, problem):
    def none(problem=problem, setup=setup, gas=AIR, condition=HERE):
        return guess.guessed(problem, setup, gas, condition) is None

    assert not none()
    assert none(setup=replace(setup, wall_temperature=351.0))
    assert none(gas=SimpleNamespace(attrs={"gas": "N2"}))
    assert none(condition=replace(HERE, numerical_power=131e3))
    assert none(condition=replace(HERE, radiation_factor=1.0))
    moved = problem.mesh.p + [[0.0, 0.0, 1e-5], [0.0, 0.0, 0.0]]
    assert none(problem=SimpleNamespace(**vars(problem) | {"mesh": SimpleNamespace(p=moved)}))
    assert none(problem=SimpleNamespace(**vars(problem) | {"mesh": SimpleNamespace(p=moved[:, :2])}))


def test_the_states_on_a_coarser_mesh_are_known_as_well(setup, states, problem):
    mesh, space = SimpleNamespace(p=problem.mesh.p[:, :1]), SimpleNamespace(size=4)
    coarse = SimpleNamespace(mesh=mesh, space=space, fixed=problem.fixed[:4], values=problem.values[:4])
    found = guess.guessed(coarse, setup, AIR, HERE)
    assert np.abs(found - states(90e3)[:4])[[0, 1, 3]].max() < 2e-3 and found[2] == 5.0


def test_the_guess_of_the_package_is_that_of_the_main_job():
    flow = yaml.safe_load((ROOT / "config/config.yaml").read_text(encoding="utf-8"))["flow"]
    torch = in_si(flow["torch"])
    wall, frequency = torch.pop("wall_temperature"), torch.pop("coil_frequency")
    torch = {name.removeprefix("torch_"): value for name, value in torch.items()}
    torch["coil_positions"] = tuple(float(place) for place in torch["coil_positions"])
    setup = Setup(Torch(**torch), float(wall), float(flow["start"]["mesh_factor"]))
    start = in_si(flow["start"])
    condition = Condition(
        start["numerical_power"],
        start["chamber_pressure"],
        start["mass_flow_rate"],
        frequency,
        in_si(flow["physics"])["probe_temperature"],
    )
    known = guess.arrays(guess.NAME)
    assert guess.told(setup, AIR, condition) == known["told"]
    np.testing.assert_array_equal(known["power"], POWER)


def test_the_minimal_run_has_the_coarsest_mesh_of_the_main_job_and_its_guess(setup):
    full, minimal = (
        yaml.safe_load((ROOT / f"config/{name}.yaml").read_text(encoding="utf-8"))["flow"]
        for name in ("config", "minimal")
    )
    factors = levels.level_factors(full["start"]["mesh_factor"], full["convergence"]["error_mesh_ratio"])
    factor = minimal["start"]["mesh_factor"]
    assert factor == full["start"]["start_mesh_factor"] == pytest.approx(factors[-1], rel=1e-9)
    mesh = build_mesh(setup.torch, factor).restrict("flow")
    assert guess._level_of(mesh.p, guess.arrays(guess.NAME)) == str(levels.COARSEST)


def test_a_changed_file_of_guesses_is_refused(tmp_path, monkeypatch):
    from plasmapyro import tables

    (tmp_path / "data").mkdir()
    np.savez(tmp_path / "data/a.npz", x=np.arange(3))
    digest = hashlib.sha256((tmp_path / "data/a.npz").read_bytes()).hexdigest()
    monkeypatch.setattr(tables, "files", lambda package: tmp_path)
    (tmp_path / "data/a.yml").write_text(f"sha256: {digest}\n")
    np.testing.assert_array_equal(tables.arrays.__wrapped__("a")["x"], np.arange(3))
    (tmp_path / "data/a.yml").write_text("sha256: 0\n")
    with pytest.raises(ValueError, match="a were changed"):
        tables.arrays.__wrapped__("a")


def test_a_guess_that_leads_nowhere_leaves_the_way_from_nothing(air, setup, monkeypatch):
    def lost(*given):
        raise NotConverged("nowhere")

    monkeypatch.setattr(stage, "is_known", lambda *given: True)
    monkeypatch.setattr(stage, "guessed", lambda *given: np.zeros(1))
    monkeypatch.setattr(stage, "problem_of", lambda *given: None)
    monkeypatch.setattr(stage, "march", lost)
    case = stage.Case(setup, lambda factor: None, stage.Air(air, None, 350.0), 0.0, 1.41, "here")
    assert stage._from_known(case, HERE, 0.02, stage.FINAL) == (None, {})


def test_solutions_on_coarser_meshes_of_another_torch_are_left_out(setup, monkeypatch):
    monkeypatch.setattr(levels, "setup_of", lambda dataset: replace(setup, wall_temperature=400.0))
    case = stage.Case(setup, None, None, 0.0, 1.41, "here")
    assert levels.known_levels({"solver_state": np.zeros(1)}, None, case, HERE) == {}
