"""Jets of the torch with radiation loss and mixing, and what probes read in them.

    python benchmarks/plasmatron_jets.py [--count N]

Of two gases, four pressures, three mixing lengths and six powers those in CASES, air on 5 000 triangles,
nitrogen on 8 300: air at 50 mbar all but 180 and 300 kW without mixing, which find no steady flow on this
mesh. Needs results/gas/air11.nc; keeps its flows in results/benchmark_flow, takes up where it stopped and
writes src/plasmapyro/data/facility/jets.csv, of which `facility.prediction` is made; rows that are there are
kept. Some 10 CPU minutes for air and 10 for nitrogen.
"""

import argparse
import hashlib
import itertools
import logging
from functools import partial
from operator import itemgetter

import flow as bench  # first: it sets one thread

from plasmapyro import io
from plasmapyro.facility.stage import probe_readings
from plasmapyro.flow.continuation import NotConverged
from plasmapyro.gas.stage import gas_table
from plasmapyro.radiation.net_emission import net_emission

TABLE = bench.ROOT / "src/plasmapyro/data/facility/jets"
MESH = {"air": 2.0, "N2": 1.41}  # on 5 000 triangles the energy of nitrogen does not close
MIXING = (0.0, 0.06, 0.12)
POWERS = (95e3, 130e3, 65e3)  # [W], each from the nearest before
CASES = [  # gas, pressure [Pa], mixing, power [W]
    *itertools.product(("air",), (5e3, 1e4), MIXING, POWERS),
    *itertools.product(("air",), (5e3,), (0.06, 0.12), (180e3, 300e3)),
    *itertools.product(("air",), (5e3,), MIXING, (45e3,)),
    *itertools.product(("air",), (2.5e3, 2e4), (0.06,), (95e3,)),
    *itertools.product(("N2",), (5e3,), (0.06, 0.12, 0.0), POWERS),
    *itertools.product(("N2",), (1e4, 2e4, 2.5e3), (0.06,), (95e3,)),
]
ABSORPTION_RADIUS = 0.04  # [m]
RATES, RECOMBINATION, NOSES = ("kossyi", "park"), (0.1, 0.01), (0.025, 0.0125, 0.005)
PROBES = {"rates": RATES, "recombination": RECOMBINATION, "pitot_radius": NOSES}
GAS, KEYS = "gas [text]", ("pressure [Pa]", "mixing [1]", "power [kW]")
PROBES |= {"probe_radius": 0.025, "wall_temperature": 350.0}


def row_of(flow, gas):
    """Row of the table of one flow."""
    found = probe_readings(flow, gas, **PROBES)
    row = {
        GAS: flow.attrs["gas"],
        "pressure [Pa]": f"{float(flow.chamber_pressure):.0f}",
        "mixing [1]": f"{float(flow.mixing):g}",
        "power [kW]": f"{float(flow.numerical_power) / 1e3:g}",
        "temperature [K]": f"{float(found.edge_temperature):.0f}",
        "enthalpy [MJ kg-1]": f"{float(found.edge_enthalpy) / 1e6:.3f}",
        "speed [m s-1]": f"{float(found.jet_speed):.1f}",
        "radiated [kW]": f"{float(flow.radiated_power) / 1e3:.2f}",
    }
    for nose, reading in zip(NOSES, found.pitot_pressure.values, strict=True):
        row[f"pitot_{1e3 * nose:g}_mm [Pa]"] = f"{reading:.2f}"
    row["flux_equilibrium [kW m-2]"] = f"{float(found.equilibrium_heat_flux) / 1e3:.1f}"
    for rates, gamma in itertools.product(RATES, RECOMBINATION):
        flux = float(found.stagnation_heat_flux.sel(rates=rates, recombination=gamma))
        row[f"flux_{rates}_{gamma:g} [kW m-2]"] = f"{flux / 1e3:.1f}"
    return row


def place_of(row):
    return row[GAS] != "air", *(float(row[key]) for key in KEYS)


def beginnings(gas):
    """Table, emission and cold start of a gas."""
    table, path = bench.air(), bench.STORE / f"emission_{gas}.nc"
    if gas == "N2":
        table = gas_table(temperature=table.temperature.values, pressure=table.pressure.values, nitrogen=1.0)
    if not path.exists():
        path.parent.mkdir(parents=True, exist_ok=True)
        io.write(net_emission(table, absorption_radius=ABSORPTION_RADIUS), path, "net_emission")
    torch = {} if gas == "air" else {"gas": table}
    return table, io.read(path, "net_emission"), bench.reference(MESH[gas], **torch)


def write(rows):
    """The table, and its digest into the certificate."""
    keys = list(rows[0])
    rows = sorted(rows, key=place_of)
    text = "\n".join([",".join(keys), *(",".join(row.values()) for row in rows)]) + "\n"
    TABLE.with_suffix(".csv").write_text(text, encoding="utf-8")
    certificate = TABLE.with_suffix(".yml")
    if certificate.exists():
        lines = certificate.read_text(encoding="utf-8").splitlines()
        digest = hashlib.sha256(text.encode()).hexdigest()
        lines = [f"sha256: {digest}" if line.startswith("sha256:") else line for line in lines]
        certificate.write_text("\n".join(lines) + "\n", encoding="utf-8")


def main(count):
    rows = bench.read_table(TABLE.with_suffix(".csv"))
    done = set(map(place_of, rows))
    for gas, cases in itertools.groupby(CASES, key=itemgetter(0)):
        cases = [(gas != "air", pressure, mixing, power / 1e3) for _, pressure, mixing, power in cases]
        if count == 0 or done.issuperset(cases):
            continue
        table, emission, start = beginnings(gas)
        known = []
        for case in cases:
            _, pressure, mixing, power = case
            name = f"jets/{gas}_{pressure / 100:g}mbar_{mixing:g}_{power:g}kW"
            if case in done and not (bench.STORE / f"{name}.nc").exists():
                continue
            if count == 0 and case not in done:
                return
            changes = {"numerical_power": 1e3 * power, "chamber_pressure": pressure, "mixing": mixing}
            compute = partial(bench.solve, table, start, known, emission, radiation_factor=1.0, **changes)
            try:
                known.append(bench.stored(name, compute))
            except NotConverged as fault:
                logging.warning("%s: %s", name, fault)
                continue
            if case not in done:
                rows.append(row_of(known[-1], table))
                logging.warning("%s: %s", name, rows[-1])
                write(rows)
                count -= 1


if __name__ == "__main__":
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--count", type=int, default=-1, help="cases that are computed now (default: all)")
    logging.basicConfig(level=logging.WARNING, format="%(asctime)s %(message)s")
    main(parser.parse_args().count)
