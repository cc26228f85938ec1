"""A job of the workflow: results in by their contracts, a function of a stage, what it returns out."""

from plasmapyro import io
from plasmapyro.quantities import in_si


def run(job, stage, contract, *, renamed=None, **made):
    """Call a function of a stage with what its rule gives, and store what it returns, of a contract.

    The rule of a `job` (the `snakemake` of a script) names each input by its contract, in the order in which
    the stage takes them; None stands for one that is left empty, unnamed ones are files that the stage finds
    by itself. The parameters of the rule are the settings of the stage, with their units in the keys.
    `renamed`: setting -> argument, where the stage has another word than the configuration; `made`: what
    makes the value of a setting from the list in the configuration, as `quantities.steps` does.
    """
    io.log_to(job.log[0])
    given = [io.read(path, kind) if path else None for kind, path in job.input.items() if kind != "script"]
    settings = in_si(job.params)
    settings |= {name: make(*settings[name]) for name, make in made.items()}
    settings = {(renamed or {}).get(name, name): value for name, value in settings.items()}
    write(job, stage(*given, **settings), contract)


def write(job, result, contract):
    """Store the result of a job, with the files and the parameters of its rule as what it was made from."""
    io.write(result, job.output[0], contract, sources=job.input, config=dict(job.params))
