"""The light of a gas with what is taken as given of it."""

from plasmapyro.radiation.foreign import more_absorbed, rippled, warmer, with_continuum, with_lines
from plasmapyro.radiation.stage import line_of_sight_radiance

TENTH = 0.1  # [1], of the light of O I 777: what amounts of lines count in
HUNDREDTH = 0.01  # [1], of the light of the gas: what a continuum counts in


def radiance_with(changes, sightline, response, **settings):
    """Light (contract 'radiation') along a sight line, with `changes` as of `terms.changes_of`."""
    levels = {name: changes[name] for name in ("excitation", "vibration") if name in changes}

    def plain(line):
        return line_of_sight_radiance(line, response, levels=levels, **settings)

    if "temperature" in changes:
        sightline = warmer(sightline, changes["temperature"])
    result = rippled(plain, sightline, changes["ripple"]) if "ripple" in changes else plain(sightline)
    if "depth" in changes:
        result = more_absorbed(result, response, changes["depth"])
    if "continuum" in changes:
        own = changes.get("continuum_own", 0.0)
        result = with_continuum(result, response, HUNDREDTH * changes["continuum"], own)
    if lines := changes.get("lines"):
        from plasmapyro.diagnosis.effects.gas import species_lines  # all of the diagnosis, a second

        for species, amount in lines.items():
            result = with_lines(result, response, species, *species_lines((species,)), TENTH * amount)
    return result
