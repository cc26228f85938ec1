import numpy as np
import pytest

from plasmapyro import contracts
from plasmapyro.gas.stage import gas_table

# Against Mutation++ at 300, 1000 ... 12000 K: same thermodynamic data at 1 atm instead of 1 bar, same
# collision integrals interpolated linearly instead of as power laws (3 % of an electron's Q at 3000 K).
RTOL = {
    "density": 2e-3,
    "enthalpy": 5e-3,
    "heat_capacity": 7e-3,
    "viscosity": 1.3e-2,
    "thermal_conductivity": 1.2e-2,
    "electrical_conductivity": 3.5e-2,
}
CANCELLATION = {"enthalpy": 100.0}  # [J kg-1]: it is near zero at 300 K

TEMPERATURE = np.arange(200.0, 15000.1, 50.0)
PRESSURE = np.array([5000.0, 10000.0, 101325.0])


@pytest.fixture(scope="module")
def table():
    return gas_table(temperature=TEMPERATURE, pressure=PRESSURE)


def test_table_honours_the_contract(table):
    contracts.check(contracts.label(table, "gas"), "gas")


@pytest.mark.parametrize("name", RTOL)
def test_properties_agree_with_mutationpp(table, published, name):
    rows = [row for row in published("air_lte_mutationpp") if row[name]]
    expected = np.array([float(row[name]) for row in rows])
    found = [
        float(table[name].sel(pressure=float(row["pressure"]), temperature=float(row["temperature"])))
        for row in rows
    ]
    assert found == pytest.approx(expected, rel=RTOL[name], abs=CANCELLATION.get(name, 0.0))


def test_properties_are_smooth_enough_for_newtons_method(table):
    """Half the step must halve the jumps of the slope: a kink or a jump would keep its size."""
    for name in ("heat_capacity", "viscosity", "thermal_conductivity", "density"):
        logarithm = np.log(table[name].sel(pressure=5000.0).values)
        fine, coarse = np.abs(np.diff(logarithm, 2)).max(), np.abs(np.diff(logarithm[::2], 2)).max()
        assert fine < 0.5 * coarse
        assert coarse < 0.3


def test_nitrogen_conducts_as_measured():
    """Dilute N2, E. W. Lemmon & R. T Jacobsen, Int. J. Thermophys. 25 (2004) 21, good to 2 %."""
    cold = gas_table(temperature=[300.0, 1000.0], pressure=[5000.0], nitrogen=1.0)
    assert cold.attrs["gas"] == "N2"
    assert cold.viscosity.values[0] == pytest.approx([17.9e-6, 41.5e-6], rel=0.03)
    assert cold.thermal_conductivity.values[0] == pytest.approx(
        [25.8e-3, 65.4e-3],
        rel=0.06,  # Eucken's correction is that good
    )


def test_a_trace_of_oxygen_changes_hot_nitrogen_by_no_more_than_its_share():
    hot = np.array([6000.0, 9000.0, 12000.0])
    pure, near = (gas_table(temperature=hot, pressure=[5000.0], nitrogen=one) for one in (1.0, 1 - 1e-7))
    for name in RTOL:
        assert near[name].values == pytest.approx(pure[name].values, rel=1e-5)  # sigma of NO+ at 6000 K: 1e-6


def test_density_is_nearly_proportional_to_pressure_in_cold_air(table):
    cold = table.density.sel(temperature=300.0).values / PRESSURE
    assert cold == pytest.approx(cold[0], rel=1e-9, abs=0)


def test_pressure_holds_dissociation_and_ionisation_back(table):
    oxygen = table.mole_fraction.sel(species="O2", temperature=3500.0).values
    electrons = table.mole_fraction.sel(species="e-", temperature=9000.0).values
    assert (np.diff(oxygen) > 0).all() and (np.diff(electrons) < 0).all()


def test_same_input_gives_the_same_bytes():
    arguments = {"temperature": TEMPERATURE[:40], "pressure": [5000.0]}
    first, second = gas_table(**arguments), gas_table(**arguments)
    for name in first.variables:
        assert first[name].values.tobytes() == second[name].values.tobytes()


@pytest.mark.parametrize(
    "temperature, pressure, message",
    [
        ([300.0, 300.0], [5000.0], "temperature must increase strictly"),
        ([300.0, 400.0], [5000.0, 4000.0], "pressure must increase strictly"),
        ([100.0, 400.0], [5000.0], r"temperature must lie in \[200, 15000\] K; got 100 K"),
        ([300.0, 400.0], [5.0], r"pressure must lie in \[100, 1e\+06\] Pa; got 5 Pa"),
    ],
)
def test_bad_axes_are_refused(temperature, pressure, message):
    with pytest.raises(ValueError, match=message):
        gas_table(temperature=temperature, pressure=pressure)
