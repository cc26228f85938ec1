"""Row (c) of the real-data board: which elements do spectra of laser plasmas in air show?

    python benchmarks/species.py FOLDER [--mixtures N]

FOLDER holds spectra of public data as CSV (wavelength [nm], signal): TheFermiSea/CF-LIBS-improved,
`data/aalto_libs`, six pure elements and six minerals, named as in `KNOWN`. The files are not ours to ship.
Mixtures are 1, 3 and 10 % of one spectrum's light in another's; false names are counted against what the two
show apart, and by decoys: the same species with every line moved by 0.8 %.
"""

import argparse
from pathlib import Path

import numpy as np

from plasmapyro.identification import identify as module
from plasmapyro.identification.species import AIR, Species, catalogue
from plasmapyro.readers.spectrum import read_frames

KNOWN = {"Al": "Al", "Cu": "Cu", "Fe": "Fe", "Mg": "Mg", "Ni": "Ni", "Ti": "Ti", "corundumE21": "Al"}
KNOWN |= {
    "fluorite39": "Ca",
    "lepidolite31": "Li",
    "microcline23": "K",
    "plagioclaseE2": "Na",
    "quartz12": "Si",
}
SHARES, SURE, CLEAR = (0.01, 0.03, 0.1), 0.9, 8.0
DECOY, MOVED = "decoy ", 1.008


def decoys():
    """The species of the package with their lines where there are none."""
    return tuple(
        Species(
            DECOY + one.name,
            DECOY + one.element,
            one.wavelength * MOVED,
            one.probability,
            one.upper,
            one.error,
        )
        for one in catalogue()
    )


def names(answer):
    """Elements named, most evidence first."""
    sure = [one.species.element for one in answer.named if one.probability >= SURE]
    return list(dict.fromkeys(sure))


def single(folder):
    """Name of a spectrum -> (answer, axis, signal) of those that are there."""
    found = {}
    for path in sorted(Path(folder).glob("*.csv")):
        if path.stem.removesuffix("_spectrum") in KNOWN:
            axis, frames = read_frames(path)
            answer = module.identify(axis, frames.mean(axis=0))
            found[path.stem.removesuffix("_spectrum")] = (answer, axis, frames.mean(axis=0))
    return found


def signal_to_noise(much, little, share, element):
    """Second largest of the lines of an element in a mixture: its light over the noise of the spectrum."""
    (major, axis, light), (minor, _, other) = much, little
    scale = share * light.sum() / other.sum()
    lines = np.unique(
        np.concatenate([one.fit.matched for one in minor.named if one.species.element == element] or [[]])
    ).astype(int)
    at = minor.peaks.wavelength[lines]
    noise = np.where(np.isfinite(major.peaks.limit), (major.peaks.limit - major.peaks.above) / 5, np.inf)
    ratios = np.interp(at, axis, minor.peaks.above) * scale / np.interp(at, axis, noise)
    return np.sort(ratios)[-2] if ratios.size > 1 else 0.0


def mixtures(found, number, seed=0):
    """Rows (major, minor, share, SNR, named, false names) of some mixtures."""
    shown = {name: set(names(answer)) for name, (answer, _, _) in found.items()}
    pairs = [(a, b) for a in found for b in found if KNOWN[a] not in shown[b] and KNOWN[b] not in shown[a]]
    np.random.default_rng(seed).shuffle(pairs)
    for a, b in pairs[:number]:
        for share in SHARES:
            (_, axis, much), (_, _, little) = found[a], found[b]
            mixed = (1 - share) * much + share * much.sum() / little.sum() * little
            told = names(module.identify(axis, mixed))
            false = [one for one in told if one not in shown[a] | shown[b] | set(AIR)]
            clear = signal_to_noise(found[a], found[b], share, KNOWN[b])
            yield a, b, share, clear, KNOWN[b] in told, false


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("folder")
    parser.add_argument("--mixtures", type=int, default=20, metavar="N", help="pairs, each at three shares")
    options = parser.parse_args()
    both = (*catalogue(), *decoys())
    module.catalogue = lambda: both
    found = single(options.folder)
    for name, (answer, _, _) in found.items():
        told = names(answer)
        right = next((one for one in told if one not in AIR), None) == KNOWN[name]
        verdict = "first" if right else "named" if KNOWN[name] in told else "MISSED"
        print(f"{name:14s} {KNOWN[name]:2s} {verdict:6s} {told}")
    seen = hit = false = told = 0
    for a, b, share, clear, named, wrong in mixtures(found, options.mixtures):
        print(f"{share:4.0%} {b} in {a}: SNR {clear:.0f}, {'named' if named else 'not named'} {wrong or ''}")
        seen, hit = seen + (clear >= CLEAR), hit + (named and clear >= CLEAR)
        false, told = false + bool(wrong), told + 1
    if told:
        print(f"named where SNR >= {CLEAR:g}: {hit} of {seen}; mixtures with a false name: {false} of {told}")


if __name__ == "__main__":
    main()
