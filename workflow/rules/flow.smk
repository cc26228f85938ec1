from math import hypot


# One cold start per gas at a reference condition; each power condition continues from that of its gas by itself, or
# from a nearer solution of an earlier run. The radiation loss is computed only where it is asked for.
def start_of(gas):
    return f"results/flow/start/{'reference' if gas == 'air11' else gas}.nc"


PHYSICS = config["flow"]["physics" if config["flow"]["model"] == "paper" else "best"]


def emission_of(gas):
    return [f"results/gas/emission/{gas}.nc"] if PHYSICS["radiation_factor"] else []


def of_gas(path):
    """Input function: what `path`, a pattern or a function, is for the gas of a condition."""
    made = path if callable(path) else lambda gas: path.format(gas=gas)
    return lambda wildcards: made(gas_key(*GAS_OF[wildcards.condition]))


STARTED = {start_of(gas_key(*gas)): gas_key(*gas) for gas in GAS_OF.values()}
RESULTS += [*STARTED, *expand("results/flow/{condition}.nc", condition=COMPUTED)]


rule flow_start:
    input:
        lambda wildcards: f"results/gas/{'air11' if wildcards.start == 'reference' else wildcards.start}.nc",
    output:
        "results/flow/start/{start}.nc",
    wildcard_constraints:
        start=one_of(["reference", *GASES]),
    params:
        **config["flow"]["start"],
        **config["flow"]["convergence"],
        probe_temperature_k=PHYSICS["probe_temperature_k"],
        torch=config["flow"]["torch"],
    script:
        "../scripts/flow_start.py"


def mixing_of(wildcards):
    """Mixing length of a condition; eddy viscosities, and so squares of mixing lengths, add."""
    own = CONDITIONS[wildcards.condition].get("mixing")
    return hypot(PHYSICS["mixing"], own) if own else PHYSICS["mixing"]


FLOW = dict(  # settings of the flow of a condition
    **config["flow"]["convergence"],
    **PHYSICS | {"mixing": mixing_of},
    coil_frequency_khz=config["flow"]["torch"]["coil_frequency_khz"],
    numerical_power_kw=lambda wildcards: CONDITIONS[wildcards.condition]["numerical_power_kw"],
    chamber_pressure_mbar=lambda wildcards: CONDITIONS[wildcards.condition]["chamber_pressure_mbar"],
    mass_flow_rate_g_s=lambda wildcards: CONDITIONS[wildcards.condition]["mass_flow_rate_g_s"],
    power_step_kw=config["flow"]["power_step_kw"],
)


rule flow:
    input:
        gas=of_gas("results/gas/{gas}.nc"),
        start=of_gas(start_of),
        neighbours=config["flow"]["neighbours"],
        emission=of_gas(emission_of),
    output:
        "results/flow/{condition}.nc",
    wildcard_constraints:
        condition=one_of(COMPUTED),
    params:
        **FLOW,
    script:
        "../scripts/flow.py"
