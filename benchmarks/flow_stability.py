"""Is the laminar jet stable? Growth of small disturbances between torch exit and probe.

    python benchmarks/flow_stability.py [FLOW.nc ...]

Takes flows of the main job (results/flow; default 60, 90, 130 kW) and its gas table; writes
docs/flow_stability.csv, and docs/flow_drift.csv on buoyancy. About a CPU minute a flow.
"""

import argparse
import json
import logging

import flow as bench  # first: it sets one thread
import jet_stability as stability
import numpy as np
from scipy.interpolate import make_lsq_spline

from plasmapyro import io
from plasmapyro.flow.properties import gas_properties
from plasmapyro.sightline.stage import on_line

FLOWS = [bench.ROOT / f"results/flow/{power}kW.nc" for power in (60, 90, 130)]
STATIONS = (0.50, 0.60, 0.78)  # [m]: the torch ends at 0.486, the nose is at 0.871
WAVE_NUMBERS = (0.7, 1.2, 2.2, 4.0)  # over the torch radius; all modes are sought at FIRST
FIRST = 1.2
POINTS = 100
PINCHED = 0.60  # [m]: station at which Briggs' criterion is tried
NAMES = ("temperature", "axial_velocity")
AZIMUTHAL = (0, 1)
CORE = 0.045  # [m]: disturbances whose axial speed is largest inside belong to the hot core
SADDLE = {0: (0.4 - 0.7j, 0.4 + 0.3j), 1: (0.8 - 2.5j, 1.1 - 0.1j)}  # guesses of alpha and omega
FREQUENCIES = np.geomspace(20.0, 3000.0, 60)  # [Hz]
SAMPLE, KNOTS, EDGE, SCALE, OUTER = 2.5e-4, 2.5e-3, 1e-6, 0.08, 0.7  # [m], of a section
LENGTH, SPEED, DENSITY, KELVIN = 0.08, 100.0, 1e-3, 1e3  # [m, m s-1, kg m-3, K]: units of `parallel_flow`
GRAVITY = 9.80665  # [m s-2]
RATE = SPEED / LENGTH  # [s-1]
HERTZ = RATE / (2 * np.pi)


def parallel_flow(flow, properties, z, points=POINTS):
    """A section of a computed flow as a parallel flow, in units of `LENGTH`, `SPEED`, `DENSITY`, `KELVIN`.

    Parameters
    ----------
    flow : Dataset, contract 'flow'
    properties : GasProperties
    z : float [m]
    points : int
        Of the grid.

    Returns
    -------
    BaseFlow
        Behind the torch exit out to 0.7 m, with the gas of the edge of the mesh beyond it: the chamber of the
        facility is wider than ours. ASSUME: radial velocity and slopes along z are left out.
    """
    edge = flow.node_r.values[flow.node_z.values < z].max()
    outer = edge
    if z > float(json.loads(flow.attrs["torch"])["length"]):
        edge, outer = flow.node_r.values.max(), OUTER
    r = np.linspace(0.0, outer, round(outer / SAMPLE) + 1)
    fields = on_line(flow, np.full_like(r, z), np.clip(r, EDGE, edge - EDGE), NAMES)
    sampled = stability.grid(outer / LENGTH, SCALE / LENGTH, points)
    knots = np.linspace(-outer, outer, 2 * round(outer / KNOTS) + 1)
    columns = {}
    for name, values in fields.items():
        spline = make_lsq_spline(
            np.concatenate([-r[:0:-1], r]),
            np.concatenate([values[:0:-1], values]),
            np.concatenate([[-outer] * 3, knots, [outer] * 3]),
        )
        columns[name] = spline(LENGTH * sampled.r), spline(LENGTH * sampled.r, 1)
    (temperature, slope), (speed, shear) = columns.values()
    density, density_slope = properties.density(temperature)
    viscosity, viscosity_slope = properties.viscosity(temperature)
    stress = DENSITY * SPEED * LENGTH
    return stability.BaseFlow(
        sampled,
        speed / SPEED,
        shear * LENGTH / SPEED,
        slope * LENGTH / KELVIN,
        density / DENSITY,
        density_slope / density * KELVIN,
        density / DENSITY * properties.heat_capacity(temperature)[0],
        viscosity / stress,
        viscosity_slope * KELVIN / stress,
        properties.thermal_conductivity(temperature)[0] / stress,
    )


def modes_of(waves):
    """Modes that grow in time: those at one wave number, each followed to longer and shorter waves."""
    for first in waves.unstable(FIRST, 0.6 * FIRST):
        yield first
        above = [alpha for alpha in WAVE_NUMBERS if alpha > FIRST]
        for way in (above, [alpha for alpha in WAVE_NUMBERS[::-1] if alpha < FIRST]):
            mode = first
            for alpha in way:
                guess = mode.omega + (alpha - mode.alpha) * mode.group_velocity
                mode = tried(waves.mode, alpha, guess, mode.disturbance)
                if mode is None or mode.omega.imag <= 0:
                    break
                yield mode


def part_of(mode, base):
    peak = base.grid.r[np.argmax(np.abs(mode.disturbance[: len(base.grid.r)]))]
    return "core" if peak * LENGTH < CORE else "sheath"


def tried(function, *arguments):
    try:
        return function(*arguments)
    except stability.NotFound:
        return None


def section(flow, properties, z):
    """Growth in space (part, m, frequency) [1/m], and by m the saddle and whether it is a pinch."""
    base = parallel_flow(flow, properties, z)
    growth, saddles = {}, {}
    for m in AZIMUTHAL:
        waves, curves, fastest = stability.Waves(base, m), {"core": [], "sheath": []}, 0.0
        for mode in modes_of(waves):
            fastest = max(fastest, mode.omega.imag)
            spatial = tried(waves.at_frequency, mode.omega.real, mode)
            if spatial is not None and spatial.alpha.real > 0:
                point = mode.omega.real * HERTZ, -spatial.alpha.imag / LENGTH
                curves[part_of(mode, base)].append(point)
        for part, found in curves.items():
            at, rates = np.array(sorted(found)).T if found else (np.array([1.0]), np.array([0.0]))
            growth[part, m] = np.interp(FREQUENCIES, at, np.maximum(rates, 0.0), left=0.0, right=0.0)
        saddle = tried(lambda waves=waves, m=m: waves.saddle(waves.mode(*SADDLE[m])))
        pinch = z == PINCHED and saddle is not None and tried(waves.pinches, saddle, fastest)
        saddles[m] = saddle, pinch
    return base, growth, saddles


def absolute_of(saddle, pinch):
    """Columns of a saddle: growth in time where it arises, frequency, and whether Briggs' criterion holds."""
    if saddle is None:
        return {"absolute_growth_per_s": "", "absolute_frequency_hz": "", "pinch": ""}
    return {
        "absolute_growth_per_s": f"{saddle.omega.imag * RATE:.0f}",
        "absolute_frequency_hz": f"{saddle.omega.real * HERTZ:.0f}",
        "pinch": {True: "yes", False: "", None: ""}[pinch],
    }


def rows_of(flow, gas):
    pressure = float(flow.chamber_pressure)
    properties = gas_properties(gas, pressure, float(flow.attrs["wall_temperature"]))
    total, before, last, rows = {}, {}, None, []
    for z in STATIONS:
        base, growth, saddles = section(flow, properties, z)
        reynolds = base.density[-1] * base.speed[-1] * 0.5 / base.viscosity[-1]
        for (part, m), rates in growth.items():
            step = 0 * rates if last is None else (z - last) * (rates + before[part, m]) / 2
            total[part, m] = total.get((part, m), 0.0) + step
            best, most = np.argmax(rates), np.argmax(total[part, m])
            rows.append(
                {
                    "power_kw": f"{float(flow.numerical_power) / 1e3:g}",
                    "mixing": f"{float(flow.attrs.get('mixing', 0.0)):g}",
                    "z_m": f"{z:g}",
                    "part": part,
                    "m": m,
                    "reynolds_axis_40mm": f"{reynolds:.0f}",
                    "growth_per_m": f"{rates[best]:.1f}",
                    "frequency_hz": f"{FREQUENCIES[best]:.0f}" if rates[best] > 0 else "",
                    "n_factor": f"{total[part, m][most]:.2f}",
                    "n_frequency_hz": f"{FREQUENCIES[most]:.0f}" if total[part, m][most] > 0 else "",
                    **absolute_of(*saddles[m]),
                }
            )
            logging.warning("%s", rows[-1])
        before, last = growth, z
    return rows


def drift_of(flow, gas):
    r"""Row of docs/flow_drift.csv: how far a horizontal jet rises until the probe.

    The core alone, without what presses on it, rises by  g (rho_0/rho - 1) (t, t)/2  along the axis; the
    whole jet, over its momentum J, by  g int (rho_0 - rho) dA L^2 / (2 J); rho_0 of the cold chamber.
    """
    pressure, wall = float(flow.chamber_pressure), float(flow.attrs["wall_temperature"])
    properties = gas_properties(gas, pressure, wall)
    begin, end = json.loads(flow.attrs["torch"])["length"], float(flow.attrs["stagnation_point_z"])
    z = np.linspace(begin, end - 0.05, 60)  # two radii ahead of the nose, as for the speed of the jet
    kelvin, speed = bench.on_axis(flow, z, "temperature", "axial_velocity")
    cold = properties.density(wall)[0]
    lift = GRAVITY * (cold / properties.density(kelvin)[0] - 1)
    step = np.diff(z) / ((speed[1:] + speed[:-1]) / 2)
    rate = np.concatenate([[0.0], np.cumsum((lift[1:] + lift[:-1]) / 2 * step)])
    core = np.sum((rate[1:] + rate[:-1]) / 2 * step)
    middle = float(z[len(z) // 2])
    r = np.linspace(0.0, float(flow.node_r.max()), 641)
    kelvin, speed = on_line(flow, np.full_like(r, middle), np.clip(r, EDGE, r[-1] - EDGE), NAMES).values()
    density = properties.density(kelvin)[0]
    ring = 2 * np.pi * r
    force = GRAVITY * np.trapezoid(ring * (cold - density), r)
    momentum = np.trapezoid(ring * density * speed**2, r)
    length = z[-1] - z[0]
    return {
        "pressure_mbar": f"{pressure / 100:g}",
        "power_kw": f"{float(flow.numerical_power) / 1e3:g}",
        "mixing": f"{float(flow.attrs.get('mixing', 0.0)):g}",
        "richardson": f"{force * length / momentum:.4f}",
        "jet_mm": f"{500 * force * length**2 / momentum:.2f}",
        "core_mm": f"{1e3 * core:.2f}",
    }


def main(paths):
    gas, rows = bench.air(), bench.read_table(bench.DOCS / "flow_stability.csv")
    jets = sorted((bench.STORE / "jets").glob("air_*5kW.nc"))  # of plasmatron_jets.py
    bench.write_table("flow_drift", [drift_of(io.read(path, "flow"), gas) for path in (*paths, *jets)])
    for path in paths:
        found = rows_of(io.read(path, "flow"), gas)
        rows = [row for row in rows if row["power_kw"] != found[0]["power_kw"]] + found
        bench.write_table("flow_stability", rows)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("flows", nargs="*", default=FLOWS)
    logging.basicConfig(level=logging.WARNING, format="%(asctime)s %(message)s")
    main(parser.parse_args().flows)
