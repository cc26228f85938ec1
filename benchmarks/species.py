"""Row (c) of the real-data board: which elements do spectra of laser plasmas in air show?

    python benchmarks/species.py FOLDER [--mixtures N] [--seed N] [--decoys] [--pairs FILE]

FOLDER holds spectra of public data as CSV (wavelength [nm], signal): TheFermiSea/CF-LIBS-improved,
`data/aalto_libs`, pure elements and minerals, named after them. The files are not ours to ship.
Mixtures are 1, 3 and 10 % of one spectrum's light in another's: the element of the admixture is to be the
likeliest of those listed that neither part shows alone. Listed is what `plasmapyro identify` prints by
default; what is listed and neither part shows is a false name, and with --decoys every decoy: the
same species with every line moved by 0.8 %. A false name is a trace if its lines speak for it in one of the
two apart as well, though not enough for the list. A fixed hash of the names halves the pairs: half 0 was
looked at while the program was made, half 1 was not (its first 16 were judged before; --skip 16 takes the
others). With --seed pairs of both halves are drawn, and each mixture is measured again: 0.05 nm of scale,
noise of half its own; --apart: each spectrum on its own scale.
Which pairs there are, what their parts show and how bright that is follows from the names of the parts. To
count two versions of the code on the same cases: --write FILE by the one (CSV, `Pair`), --pairs FILE in both.
"""

import argparse
import csv
import re
import zlib
from pathlib import Path
from typing import NamedTuple

import numpy as np

from plasmapyro.identification import identify as module
from plasmapyro.identification.evidence import Scene, together
from plasmapyro.identification.peaks import noise_of
from plasmapyro.identification.species import AIR, Species, catalogue
from plasmapyro.readers.spectrum import read_frames

MINERALS = {  # what a file's name begins with -> elements of the formula, the one that tells it first
    "corundum": "Al",
    "fluorite": "Ca F",
    "lepidolite": "Li K Rb Al Si F",
    "microcline": "K Al Si",
    "plagioclase": "Na Ca Al Si",
    "quartz": "Si",
}
SHIFTED, AGAIN = 0.05e-9, 0.5  # [m], and of the noise that a spectrum has
SHARES, LISTED, SURE, CLEAR = (0.01, 0.03, 0.1), 0.5, 0.9, 8.0
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


def names(answer, least=SURE):
    """Elements of at least a probability, most evidence first."""
    told = [one.species.element for one in answer.named if one.probability >= least]
    return list(dict.fromkeys(told))


def likeliest(answer, known):
    """The likeliest element of those listed that are not known, or None."""
    new = [one for one in answer.named if one.probability >= LISTED and one.species.element not in known]
    return max(new, key=lambda one: one.probability).species.element if new else None


def word_of(path):
    """What a file's name begins with, without the number of the piece: "Al_2.csv", "corundumE21.csv"."""
    return re.match(r"[^\W\d_]*?(?=E?\d|[\W_]|$)", path.stem)[0] or path.stem


def known(path):
    """Elements of which a file's name speaks ("Al.csv", "quartz12_spectrum.csv"), or none."""
    stem = word_of(path)
    mineral = next((MINERALS[name].split() for name in MINERALS if stem.lower().startswith(name)), None)
    return mineral or [stem] * (stem in {one.element for one in catalogue()})


def verdict(elements, told):
    """Whether what is named first beside the air belongs there, and what of it is not named."""
    missed = [one for one in elements if one not in told]
    first = "right name first" if told and told[0] in elements else "MISSED"
    return f"{first}; not named: {' '.join(missed)}" if missed else first


def single(folder):
    """Name of a spectrum -> (answer, axis, signal, element) of those whose elements are known."""
    found = {}
    for path in sorted(Path(folder).glob("*.csv")):
        if known(path):
            axis, frames = read_frames(path)
            light = frames.mean(axis=0)
            found[path.stem] = (module.identify(axis, light), axis, light, known(path)[0])
    return found


class Pair(NamedTuple):
    """Two spectra, and what code that looked at each alone says of them.

    `element`: what is to be named; `shown`: elements that either lists, which are no false names; `snr`: of
    the second largest line of the element if the whole light of the admixture lies on the host.
    """

    host: str
    admixture: str
    element: str
    shown: tuple
    snr: float


def pairs_of(found):
    """All pairs of which neither shows the element of the other for sure."""
    shown = {name: names(answer) for name, (answer, *_) in found.items()}
    listed = {name: names(answer, LISTED) for name, (answer, *_) in found.items()}
    return [
        Pair(a, b, found[b][3], (*listed[a], *listed[b]), signal_to_noise(found[a], found[b], found[b][3]))
        for a in found
        for b in found
        if found[a][3] not in (*shown[b], found[b][3]) and found[b][3] not in shown[a]
    ]


def write(path, pairs):
    """Write a list of pairs as CSV, elements that are shown apart by spaces."""
    with Path(path).open("w", newline="", encoding="utf-8") as file:
        rows = csv.writer(file)
        rows.writerow(Pair._fields)
        rows.writerows(one._replace(shown=" ".join(one.shown)) for one in pairs)


def read(path):
    """The pairs of such a list."""
    with Path(path).open(newline="", encoding="utf-8") as file:
        rows = [Pair(**row) for row in csv.DictReader(file)]
    return [one._replace(shown=tuple(one.shown.split()), snr=float(one.snr)) for one in rows]


def drawn(pairs, number, half, skip, rng):
    """Those of the pairs that are tried: of one half, or of both as a generator draws them."""
    if rng is not None:
        pairs = [pairs[place] for place in rng.permutation(len(pairs))]
    else:
        code = {one: zlib.crc32(f"{one.host}/{one.admixture}".encode()) for one in pairs}
        pairs = sorted((one for one in pairs if code[one] % 2 == half), key=code.get)
    return pairs[skip:][:number]


def signal_to_noise(much, little, element):
    """Second largest of the lines of an element: its light over the noise of the host, as bright as that."""
    (major, axis, light, _), (minor, _, other, _) = much, little
    scale = light.sum() / other.sum()
    lines = np.unique(
        np.concatenate([one.fit.matched for one in minor.named if one.species.element == element] or [[]])
    ).astype(int)
    at = minor.peaks.wavelength[lines]
    seen = np.interp(axis, major.peaks.axis, np.isfinite(major.peaks.limit)) == 1
    noise = np.where(seen, noise_of(light), np.inf)
    ratios = np.interp(at, minor.peaks.axis, minor.peaks.above) * scale / np.interp(at, axis, noise)
    return np.sort(ratios)[-2] if ratios.size > 1 else 0.0


def trace(one, axis, answer):
    """Whether the lines of a species speak for it in a spectrum, be it ever so little."""
    scene = Scene(answer.peaks, module.UNCALIBRATED, answer.scale, module.PLACE)
    margin = 2 * answer.peaks.slit.max()
    others = together(other.fit.explained for other in answer.named if other.species.name != one.name)
    own = next(other for other in catalogue() if other.name == one.name)
    fit = scene.fit(own.between(axis[0] + margin, axis[-1] - margin), others)
    return fit is not None and fit.log_bayes > 0


def again(axis, light, shift, rng):
    """A spectrum as it might be measured once more: a scale off by `shift` [m], and more noise."""
    moved = np.interp(axis - shift, axis, light)
    noise = AGAIN * noise_of(light) * rng.standard_normal(light.size)
    return np.where(moved > light.min(), np.maximum(moved + noise, light.min()), moved)


def mixtures(found, pairs, rng=None, apart=False):
    """Rows (pair, share, whether the element is the likeliest new one, whether it is sure, false names, those
    that are no traces) of mixtures.

    With a generator each spectrum is measured `again`: with one scale, as one spectrometer has, or `apart`,
    each with its own.
    """
    for pair in pairs:
        a, b = pair.host, pair.admixture
        for share in SHARES:
            (_, axis, much, _), (_, _, little, _) = found[a], found[b]
            if rng is not None:
                shift = rng.normal(0, SHIFTED, 2) if apart else np.full(2, rng.normal(0, SHIFTED))
                much, little = (again(axis, *one, rng) for one in zip((much, little), shift, strict=True))
            mixed = (1 - share) * much + share * much.sum() / little.sum() * little
            answer = module.identify(axis, mixed)
            known = {*pair.shown, *AIR} - {pair.element}
            told = names(answer, LISTED)
            false = [one for one in told if one not in (*pair.shown, *AIR)]
            traces = {
                one.species.element
                for one in answer.named
                if one.species.element in false
                and any(trace(one.species, axis, found[part][0]) for part in (a, b))
            }
            first, sure = likeliest(answer, known) == pair.element, pair.element in names(answer)
            yield pair, share, first, sure, false, [one for one in false if one not in traces]


def board(
    folder, number, half=1, skip=0, say=lambda *_: None, chance=False, seed=None, apart=False, pairs=None
):
    """Rows (share, mixtures of SNR `CLEAR` or more, right names first in these, with 0.9, with a false name,
    with one that is no trace, all), of `pairs` or of those that this code sees."""
    both = (*catalogue(), *decoys()) if chance else catalogue()
    module.catalogue = lambda: both
    rows = {share: np.zeros(6, int) for share in SHARES}
    rng, found = None if seed is None else np.random.default_rng(seed), single(folder)
    tried = drawn(pairs or pairs_of(found), number, half, skip, rng)
    for pair, share, first, sure, false, wrong in mixtures(found, tried, rng, apart):
        snr = share * pair.snr
        more = f"{false or ''}" + f", no trace: {wrong}" * bool(wrong)
        of = f"{pair.admixture} in {pair.host}"
        word = ("named" if first else "not named") + " with 0.9" * sure
        say(f"{share:4.0%} {of}: SNR {snr:.0f}, {word} {more}")
        clear = snr >= CLEAR
        rows[share] += [clear, clear and first, clear and sure, bool(false), bool(wrong), 1]
    module.catalogue = catalogue
    return [(share, *counts) for share, counts in rows.items()]


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("folder")
    parser.add_argument("--mixtures", type=int, metavar="N", help="pairs, each at three shares; default: all")
    parser.add_argument("--half", type=int, default=1, choices=(0, 1), help="of the pairs")
    parser.add_argument("--skip", type=int, default=0, metavar="N", help="of the pairs, before these")
    parser.add_argument(
        "--seed", type=int, help="draw pairs of both halves, with scale and noise of their own"
    )
    parser.add_argument("--decoys", action="store_true", help="as many invented species in the race")
    parser.add_argument(
        "--apart", action="store_true", help="both spectra of a mixture on scales of their own"
    )
    parser.add_argument("--pairs", metavar="FILE", help="the pairs to draw from, not those this code sees")
    parser.add_argument("--write", metavar="FILE", help="write all pairs that this code sees, try none")
    options = parser.parse_args()
    if options.write:
        return write(options.write, pairs_of(single(options.folder)))
    rows = board(
        options.folder,
        options.mixtures,
        options.half,
        options.skip,
        lambda line: print(line, flush=True),
        options.decoys,
        options.seed,
        options.apart,
        options.pairs and read(options.pairs),
    )
    _, clear, first, sure, false, wrong, count = np.sum(rows, axis=0)
    print(f"named first where SNR >= {CLEAR:g}: {first:g} of {clear:g}, with {SURE:g} {sure:g};")
    print(f"with a false name: {false:g} of {count:g},")
    print(f"with one that is no trace: {wrong:g}")


if __name__ == "__main__":
    main()
