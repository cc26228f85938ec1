"""The scene of a test of the main job, with the effects that its configuration hides."""

from twin import gas, hidden, incident
from twin.campaign import Scene

BOLTZMANN = 1.380649e-23


def scene(condition, effects, weighted, profile):
    """A scene, the plain one if nothing is hidden.

    Parameters
    ----------
    condition : str
        Simulation that the laboratory compares with.
    effects : sequence of dict
        `effect`, `amplitude` and, if wanted, `shape`, as for `hidden.hide`.
    weighted : sequence of (weight, Dataset)
        The true gas, radiance by component.
    profile : (sightline, composition) Datasets, and flow if a surface scatters, or empty if nothing is hidden
    """
    plain = Scene(condition=condition)
    if not effects:
        return plain
    told = Scene(condition=condition, centred_exposures=True)
    plasma = _gas(weighted, told.chamber_pressure, *profile)
    for one in effects:
        told = hidden.hide(told, one["effect"], one["amplitude"], plasma, one.get("shape"))
    return told


def _gas(weighted, pressure, sightline, composition, flow=None):
    kept = [gas.spectra([dataset], [1.0]) for _, dataset in weighted]
    radiance = sum(weight * one.radiance[0] for (weight, _), one in zip(weighted, kept, strict=True))
    at = composition.sel(pressure=pressure, method="nearest")
    number = float(at.pressure) / (BOLTZMANN * at.temperature.values)
    return gas.Gas(
        kept[0].centres,
        kept[0].systems,
        radiance,
        sightline.path_distance.values,
        sightline.temperature.values,
        at.temperature.values,
        {str(name): number * at.mole_fraction.sel(species=name).values for name in at.species.values},
        view=None if flow is None else incident.view(flow, at.temperature.values),
    )
