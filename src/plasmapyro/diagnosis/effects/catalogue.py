"""The catalogue: everything that the diagnosis knows by name, in the order of the way of the light."""

from dataclasses import replace
from difflib import get_close_matches
from types import MappingProxyType

from plasmapyro.diagnosis.effects import gas, instrument, path, surface
from plasmapyro.diagnosis.effects.effect import Effect

CATALOGUE = MappingProxyType(
    {
        found.id: found
        for module in (surface, gas, path, instrument)
        for found in vars(module).values()
        if isinstance(found, Effect)
    }
)


# Effects whose formulas take spectra of `variations`.
NEED_VARIATIONS = ("P_eff", "ripple", "T_exc", "T_vib", "selfabs", "refl", "bl", "CN")
# Numbers that nothing but a second instrument tells: how unequal the temperature is over spots of two sizes.
OF_TWO_SPOTS = ("grad", "profile")


def of_one_spot(effects):
    """The effects {id: Effect} as one instrument alone sees them, without a number that nothing tells."""
    identity, number = OF_TWO_SPOTS
    if identity not in effects:
        return effects
    one = effects[identity]
    kept = [{name: value for name, value in shape.items() if name != number} for shape in one.shapes]
    bounds = {name: value for name, value in one.shape_bounds.items() if name != number}
    shapes = tuple(shape for place, shape in enumerate(kept) if shape not in kept[:place])
    return MappingProxyType({**effects, identity: replace(one, shapes=shapes, shape_bounds=bounds)})


def without(effects, ids):
    """The effects {id: Effect} but for some.

    Raises
    ------
    ValueError
        An id that is not among them.
    """
    for one in sorted(set(ids) - set(effects)):
        near = get_close_matches(one, effects, n=1, cutoff=0.5)
        hint = f"did you mean '{near[0]}'?" if near else f"known are {', '.join(effects)}"
        raise ValueError(f"'{one}', to be left out, is no effect of the catalogue; {hint}")
    return MappingProxyType({identity: one for identity, one in effects.items() if identity not in ids})
