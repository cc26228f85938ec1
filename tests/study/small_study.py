"""A study of two invented flows, one of which is said not to exist: no flow has to be computed for it."""

from pathlib import Path

import clone
import numpy as np
import xarray as xr
import yaml
from snakemake.utils import update_config

from plasmapyro import io
from plasmapyro.study import stage

ROOT = Path(__file__).resolve().parents[2]
NOSE, RADIUS = 0.871, 0.16  # [m], of the shipped torch


def snakemake(folder, *arguments):
    """Call Snakemake on the study; return its exit code and all that it says."""
    run = clone.snakemake(folder, *arguments, "--configfile", "study.yaml")
    return run.returncode, run.stdout + run.stderr


def write(folder, *, extra=(), **changes):
    """Write study.yaml: three powers, two pressures, two emittances, two angles, or axes of your own."""
    axes = {
        "numerical_power_kw": [80, 90, 100],
        "chamber_pressure_mbar": [50, 60],
        "mass_flow_rate_g_s": [16],
        "emittance": [0.5, 0.85],
        "angle_deg": [35, 50],
    }
    study = {
        "axes": {**axes, **changes},
        "extra": list(extra),
        "object_temperature_k": [800, 2400, 400],
        "longest_chain": 3,
    }
    (folder / "study.yaml").write_text(yaml.safe_dump({"study": study}))


def prepare(folder, **changes):
    """Write the study, its flows and a coarse configuration; return the latter and the flow that exists."""
    write(folder, numerical_power_kw=[80, 90], chamber_pressure_mbar=[50], **changes)
    for name in ("gas/air11.nc", "flow/start/reference.nc"):
        path = folder / "results" / name
        path.parent.mkdir(parents=True)
        path.touch()
    flow = invented_flow(80e3, 5600.0)
    lost = flow[["numerical_power", "chamber_pressure", "mass_flow_rate"]]
    lost = lost.assign(numerical_power=90e3, flow_status=np.int8(stage.EXTINGUISHED)).assign_attrs(
        reason="out"
    )
    for power, dataset in (("80", flow), ("90", lost)):
        io.write(dataset, folder / f"results/study/flow/{power}kW_50mbar_16gs.nc", "study_flow")
    config, minimal = (
        yaml.safe_load((folder / f"config/{name}.yaml").read_text()) for name in ("config", "minimal")
    )
    update_config(config, minimal)
    config["sightline"]["points"] = 20
    (folder / "config/config.yaml").write_text(yaml.safe_dump(config))
    return config, flow


def invented_flow(power, peak):
    """A jet on a small mesh of P2 triangles, in a file as the rule study_flow leaves it."""
    columns, rows = 16, 8
    z, r = np.meshgrid(
        np.linspace(0, NOSE, 2 * columns + 1), np.linspace(0, RADIUS, 2 * rows + 1), indexing="ij"
    )
    number = np.arange(z.size).reshape(z.shape)
    corner, middle = [], []
    for i in range(0, 2 * columns, 2):
        for k in range(0, 2 * rows, 2):
            for one in ([(i, k), (i + 2, k), (i, k + 2)], [(i + 2, k + 2), (i, k + 2), (i + 2, k)]):
                corner.append([number[node] for node in one])
                middle.append(
                    [
                        number[(a[0] + b[0]) // 2, (a[1] + b[1]) // 2]
                        for a, b in zip(one, one[1:] + one[:1], strict=True)
                    ]
                )
    z, r = z.ravel(), r.ravel()
    return xr.Dataset(
        {
            "node_z": ("node", z),
            "node_r": ("node", r),
            "face_node": (("face", "corner"), np.array(corner)),
            "face_midnode": (("face", "corner"), np.array(middle)),
            "temperature": ("node", 350 + peak * (1 - np.exp(-(NOSE - z) / 0.02)) / (1 + (r / 0.06) ** 8)),
            "pressure": ("node", np.full(z.size, 5e3)),
            "numerical_power": float(power),
            "chamber_pressure": 5e3,
            "mass_flow_rate": 0.016,
            "flow_status": np.int8(stage.COMPUTED),
        },
        attrs={"stagnation_point_z": NOSE},
    )
