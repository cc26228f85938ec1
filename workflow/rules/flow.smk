from math import hypot


# One cold start per gas at a reference condition; each power condition continues from that of its gas by itself, or
# from a nearer solution of an earlier run. The radiation loss is computed only where it is asked for.
def start_of(gas):
    return f"results/flow/start/{'reference' if gas == 'air11' else gas}.nc"


SECTION = {"paper": "physics", "best": "best"}
COLD = {  # walls of which a section need not speak
    name: config["flow"]["torch"]["wall_temperature_k"]
    for name in ("tube_wall_temperature_k", "chamber_wall_temperature_k")
}
PHYSICS = COLD | config["flow"][SECTION[config["flow"]["model"]]]


def physics_of(condition):
    """What the flow of a condition holds; eddy viscosities, and so squares of mixing lengths, add."""
    case = CONDITIONS[condition]
    own = dict(case.get("flow", {}))
    found = COLD | config["flow"][SECTION[own.pop("model", config["flow"]["model"])]] | own
    return found | ({"mixing": hypot(found["mixing"], case["mixing"])} if case.get("mixing") else {})


def emission_of(gas, physics):
    return [f"results/gas/emission/{gas}.nc"] if physics["radiation_factor"] else []


def loss_of(wildcards):
    return emission_of(gas_key(*GAS_OF[wildcards.condition]), physics_of(wildcards.condition))


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


def of_physics(name):
    return lambda wildcards: physics_of(wildcards.condition)[name]


FLOW = dict(  # settings of the flow of a condition
    **config["flow"]["convergence"],
    **{name: of_physics(name) for name in PHYSICS},
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
        emission=loss_of,
    output:
        "results/flow/{condition}.nc",
    wildcard_constraints:
        condition=one_of(COMPUTED),
    params:
        **FLOW,
    script:
        "../scripts/flow.py"
