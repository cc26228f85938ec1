"""The catalogue: everything that the diagnosis knows by name, in the order of the way of the light."""

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
