# Conditions that bring the flow field of another program: only their line of sight is taken from it.
import re

from plasmapyro.cfd import map_of

RESULTS += expand("results/flow/{condition}.vtu", condition=COMPUTED)


def one_of(names):
    return "|".join(map(re.escape, names)) or "(?!)"


rule cfd_sightline:
    input:
        file=lambda wildcards: CONDITIONS[wildcards.condition]["cfd"]["file"],
        mesh=lambda wildcards: CONDITIONS[wildcards.condition]["cfd"].get("mesh", []),
    output:
        "results/sightline/{condition}.nc",
    wildcard_constraints:
        condition=one_of(CFD_CONDITIONS),
    params:
        **config["sightline"],
        map=lambda wildcards: map_of(CONDITIONS[wildcards.condition]),
        state=lambda wildcards: {
            key: CONDITIONS[wildcards.condition].get(key)
            for key in ("numerical_power_kw", "chamber_pressure_mbar", "mass_flow_rate_g_s")
        },
    script:
        "../scripts/cfd_sightline.py"


rule cfd_surface_view:
    input:
        file=lambda wildcards: CONDITIONS[wildcards.condition]["cfd"]["file"],
        mesh=lambda wildcards: CONDITIONS[wildcards.condition]["cfd"].get("mesh", []),
    output:
        "results/surface_view/{condition}.nc",
    wildcard_constraints:
        condition=one_of(CFD_CONDITIONS),
    params:
        **config["reflection"],
        angle_deg=config["sightline"]["angle_deg"],
        map=lambda wildcards: map_of(CONDITIONS[wildcards.condition]),
    script:
        "../scripts/cfd_surface_view.py"


# One job for all, because opening a Python takes longer than writing a file.
rule flow_vtu:
    input:
        flows=expand("results/flow/{condition}.nc", condition=COMPUTED),
    output:
        expand("results/flow/{condition}.vtu", condition=COMPUTED),
    script:
        "../scripts/flow_vtu.py"
