"""Whatever quantity a file gives of the species, the same gas comes out; two temperatures are passed on."""

import cfd_samples as samples
import numpy as np
import pytest

from plasmapyro.cfd.composition import from_shares
from plasmapyro.cfd.stage import sightline
from plasmapyro.constants import ATOMIC_MASS, AVOGADRO, BOLTZMANN
from plasmapyro.gas.equilibrium import number_density
from plasmapyro.gas.species import SPECIES
from plasmapyro.sightline import neqair

FLOAT_RTOL = 1e-9  # the file's eleven digits
MASS = {"N2": 28.014, "O2": 31.998, "NO": 30.006, "N": 14.007, "O": 15.999, "NO+": 30.006, "N+": 14.007}
"""[u], IUPAC 2009, without the electron's mass of the ions."""

T = np.array([4000.0, 7000.0, 9500.0])
P = np.array([5000.0, 5010.0, 4990.0])


def test_all_quantities_of_equilibrium_air_give_its_densities():
    density = dict(zip(SPECIES, number_density(T, P).T, strict=True))
    total = sum(density.values())
    masses = {name: ATOMIC_MASS * (14.007 * name.count("N") + 15.999 * name.count("O")) for name in SPECIES}
    for name in ("N2", "N2+"):
        masses[name] = 28.014 * ATOMIC_MASS
    for name in ("O2", "O2+"):
        masses[name] = 31.998 * ATOMIC_MASS
    masses["e-"] = 9.1093837e-31
    rho = sum(density[name] * masses[name] for name in SPECIES)
    given = {
        "number_density": density,
        "mole_fraction": {name: n / total for name, n in density.items()},
        "partial_density": {name: n * masses[name] for name, n in density.items()},
        "mass_fraction": {name: n * masses[name] / rho for name, n in density.items()},
    }
    for quantity, values in given.items():
        for stated in (None, rho):
            names, found = from_shares(
                quantity,
                values,
                temperature=T,
                electron_temperature=None,
                pressure=P,
                density=stated,
                missing_share=0.01,
            )
            assert names == list(SPECIES)
            expected = np.array([density[name] for name in SPECIES])
            # The ions' masses here lack the electron's, 4e-5 of them at most; electrons carry little mass.
            assert found == pytest.approx(expected, rel=1e-4, abs=0)


def shares(quantity="mole_fraction", missing_share=0.01, density=None, hot=None, **values):
    values = {name.replace("_plus", "+"): np.full(3, value) for name, value in values.items()}
    return from_shares(
        quantity,
        values,
        temperature=T,
        electron_temperature=hot,
        pressure=P,
        density=density,
        missing_share=missing_share,
    )


def test_electrons_that_are_not_given_balance_the_ions():
    names, found = shares(N2=0.5, N=0.3, O=0.14, N_plus=0.02, NO_plus=0.01)
    electrons = found[names.index("e-")]
    assert electrons == pytest.approx(found[names.index("N+")] + found[names.index("NO+")], rel=1e-12)
    assert found.sum(axis=0) * BOLTZMANN * T == pytest.approx(P, rel=1e-12)


@pytest.mark.parametrize("quantity", ["mass_fraction", "partial_density"])
def test_electrons_balance_the_ions_by_number_not_by_mass(quantity):
    rho = P * 14.007 * ATOMIC_MASS / (BOLTZMANN * T * 1.2)
    scale = rho if quantity == "partial_density" else 1.0
    values = {"N": 0.8 * scale, "N+": 0.2 * scale}
    names, found = from_shares(
        quantity,
        {name: np.broadcast_to(value, 3) for name, value in values.items()},
        temperature=T,
        electron_temperature=None,
        pressure=P,
        density=None,
        missing_share=0.01,
    )
    assert found[names.index("e-")] == pytest.approx(found[names.index("N+")], rel=1e-12)
    assert found[names.index("N+")] == pytest.approx(0.25 * found[names.index("N")], rel=1e-4)


def test_mass_fractions_without_density_use_the_pressure():
    names, found = shares("mass_fraction", N2=0.5, O=0.5)
    ratio = found[names.index("N2")] / found[names.index("O")]
    assert ratio == pytest.approx(MASS["O"] / MASS["N2"], rel=1e-6)
    assert found.sum(axis=0) * BOLTZMANN * T == pytest.approx(P, rel=1e-12)


def test_the_pressure_of_electrons_is_at_their_own_temperature():
    names, found = shares(N=0.8, N_plus=0.1, hot=2 * T)
    electrons = found[names.index("e-")]
    assert BOLTZMANN * ((found.sum(axis=0) - electrons) * T + electrons * 2 * T) == pytest.approx(
        P, rel=1e-12
    )


def test_carbon_species_are_kept():
    names, found = shares(N2=0.9, CN=0.1)
    assert names[-1] == "CN"
    assert found[-1] == pytest.approx(0.1 * P / (BOLTZMANN * T), rel=1e-12)


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ({"N2": 0.5, "O": 0.3}, "must add up to 1; the species named add up to 0.8"),
        ({"N2": 50.0, "O": 50.0}, "must add up to 1; the species named add up to 100"),
        ({"N2": 1.1, "O": -0.1}, "mole_fraction of O must be >= 0; got -0.1"),
        ({"quantity": "number_density", "N2": 1e17}, "the species make a pressure of"),
        ({"quantity": "partial_density", "N2": 3.0}, "the species make a pressure of"),
        ({"N2": 1.0, "density": np.full(3, 40.0)}, "the species make a density of"),
    ],
)
def test_shares_that_are_no_gas(values, words):
    with pytest.raises(ValueError) as caught:
        shares(**values)
    assert words in str(caught.value)


def test_a_share_that_is_not_named_may_be_allowed():
    names, found = shares(N2=0.5, O=0.3, missing_share=0.25)
    assert found[names.index("N2")] == pytest.approx(0.5 * P / (BOLTZMANN * T), rel=1e-12)


def test_rounding_below_zero_is_zero():
    names, found = shares(N2=1.0, O=-1e-9)
    assert (found[names.index("O")] == 0).all()


def species_settings(**changes):
    species = {"quantity": "mole_fraction", "unit": "1", "names": {"N2": "N2", "O": "O", "N": "N"}}
    return samples.settings(species={**species, **changes})


def test_species_of_a_file_by_their_names():
    line = sightline(samples.FILES / "mixed_ascii.vtu", species_settings(), points=60)
    total = line.pressure.values / (BOLTZMANN * line.temperature.values)
    for name, share in {"N2": 0.6, "O": 0.3, "N": 0.1, "O2": 0.0}.items():
        assert line.number_density.sel(species=name).values == pytest.approx(share * total, rel=FLOAT_RTOL)


def test_percent_and_moles_are_undone(tmp_path):
    (tmp_path / "a.csv").write_text("s,T,p,N2,O\n0,500,5000,60,40\n0.1,5000,5000,60,40\n")
    species = {"quantity": "mole_fraction", "unit": "%", "names": {"N2": "N2", "O": "O"}}
    mapping = samples.settings("profile", coordinates={"distance": "s"}, ray=None, species=species)
    line = sightline(tmp_path / "a.csv", mapping, points=60)
    n = 5000 / (BOLTZMANN * np.array([500.0, 5000.0]))
    assert line.number_density.sel(species="O").values == pytest.approx(0.4 * n, rel=1e-12)
    moles = n / AVOGADRO
    (tmp_path / "b.csv").write_text(f"s,T,p,c\n0,500,5000,{moles[0]:.15e}\n0.1,5000,5000,{moles[1]:.15e}\n")
    species = {"quantity": "molar_density", "unit": "mol/m3", "names": {"N2": "c"}}
    line = sightline(tmp_path / "b.csv", {**mapping, "species": species}, points=60)
    assert line.number_density.sel(species="N2").values == pytest.approx(n, rel=1e-12)


def two_temperatures(tmp_path, **changes):
    (tmp_path / "a.csv").write_text(
        "s,T,Tr,Tv,Te,p,N2,N,Np\n0,3000,3100,5000,5200,5000,0.5,0.4,0.05\n0.1,4000,4100,6000,6200,5000,0.5,0.4,0.05\n"
    )
    names = {"rotational_temperature": "Tr", "vibrational_temperature": "Tv", "electron_temperature": "Te"}
    variables = {**samples.STATE, **{key: {"name": name, "unit": "K"} for key, name in names.items()}}
    species = {"quantity": "mole_fraction", "unit": "1", "names": {"N2": "N2", "N": "N", "N+": "Np"}}
    mapping = samples.settings(
        "profile",
        coordinates={"distance": "s"},
        ray=None,
        variables=variables,
        species=species,
        excitation="electron_temperature",
    )
    return sightline(tmp_path / "a.csv", {**mapping, **changes}, points=60)


def test_non_equilibrium_temperatures_are_passed_on(tmp_path):
    line = two_temperatures(tmp_path)
    assert list(line.temperature.values) == [3000, 4000]
    assert list(line.excitation_temperature.values) == [5200, 6200]
    assert list(line.rotational_temperature.values) == [3100, 4100]
    assert list(line.vibrational_temperature.values) == [5000, 6000]
    assert list(line.electron_temperature.values) == [5200, 6200]
    text = neqair.compose(line)
    row = text.splitlines()[-1].split()
    assert [float(word) for word in row[3:7]] == [4000, 4100, 6000, 6200]
    vibrational = two_temperatures(tmp_path, excitation="vibrational_temperature")
    assert list(vibrational.excitation_temperature.values) == [5000, 6000]
    # The pressure of the electrons stays at their own temperature, whichever excites.
    assert (vibrational.number_density.values == line.number_density.values).all()
    electrons = line.number_density.sel(species="e-")
    heavy = line.number_density.sum("species") - electrons
    own = BOLTZMANN * (heavy * line.temperature + electrons * line.electron_temperature)
    assert own.values == pytest.approx(line.pressure.values, rel=1e-12)


def test_two_temperatures_and_equilibrium_contradict_each_other(tmp_path):
    with pytest.raises(ValueError, match="species: equilibrium needs one temperature"):
        two_temperatures(tmp_path, species="equilibrium")
