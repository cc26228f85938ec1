"""Text files of unknown origin: bounded size, tolerant decoding, strict numbers, clear refusals."""

import codecs
import math
import re
import zlib
from pathlib import Path

from plasmapyro.contracts import ContractError, check, label
from plasmapyro.foreign import printable, unfit
from plasmapyro.foreign import quote as quote

GZIP = b"\x1f\x8b"
ZIP = b"PK\x03\x04"
BINARY = {  # how other files begin, what they are, what to do with them
    b"\x89HDF": ("an HDF5, netCDF-4 or Matlab 7.3 file", "it must end in .h5, .nc or .mat"),
    b"CDF\x01": ("a netCDF file", "it must end in .nc"),
    b"CDF\x02": ("a netCDF file", "it must end in .nc"),
    b"MATLAB 5": ("a Matlab file", "it must end in .mat"),
    b"\xd0\xcf\x11\xe0": ("a workbook or document of old Office", "save the sheet as CSV"),
    ZIP: ("a packed file or a workbook", "save the sheet as CSV (UTF-8), or unpack it"),
    b"TDSm": ("a TDMS file", "it must end in .tdms"),
    b"%PDF": ("a PDF", "export the data as text"),
    b"Andor Te": ("a SIF file of Andor Solis", "export it as ASCII (.asc)"),
}
NUMBER = re.compile(r"[+-]?(?:\d{1,40}\.?\d{0,40}|\.\d{1,40})(?:[eEdD][+-]?\d{1,3})?", re.ASCII)
# Thousands that nothing else can be: groups of three before another decimal sign, two groups or more, or
# between blanks or apostrophes that no line of numbers has within a cell.
GROUPED = {
    decimal: re.compile(
        rf"[+-]?\d{{1,3}}(?:(?:\{other}\d{{3}})+\{decimal}\d{{1,40}}"
        rf"|(?:[\u00a0\u2009\u202f'\u2019]\d{{3}})+(?:\{decimal}\d{{1,40}})?)"
        rf"|[+-]?[1-9]\d{{0,2}}(?:\{other}\d{{3}}){{2,5}}"
        rf"|[+-]?\d{{1,2}}(?:\{other}\d\d)+\{other}\d{{3}}(?:\{decimal}\d{{1,40}})?",  # of India: 1,06,038.4
        re.ASCII,
    )
    for decimal, other in (".,", ",.")
}
ONE_GROUP = {  # 1,234: thousands only where the decimal sign is known to be the other one
    decimal: re.compile(rf"[+-]?[1-9]\d{{0,2}}\{other}\d{{3}}", re.ASCII) for decimal, other in (".,", ",.")
}
WHOLE = re.compile(r"\d{1,15}", re.ASCII)  # a count; `str.isdigit` also takes '²'
ALIKE = 50  # lines that say how long the last number of a line is
LAST_DIGITS = re.compile(r"([.,;\s|])(\d+)$", re.ASCII)
MISSING = re.compile(  # what meters and spreadsheets write in the place of a number, in lower case
    r"|n/?a|[-+]?(nan|inf)(\(ind\))?|[-+]?\u221e|-{1,16}|\*{1,16}|\?|\(?null\)?|none|nil|err(or)?|bad|invalid|missing"
    r"|over([- ]?(range|load|flow))?|ovl?d?|ovf|ovrng|o\.?l|under([- ]?range)?|sat(urated)?"
    r"|[<>] ?\d{1,15}([.,]\d{1,15})?|#[\w/]+[!?]?|[-+]?1\.#(inf|ind|qnan|snan|j)"
)
# no sample; SCPI: over, under, none
FILLS = (-999.0, -999.25, -9999.0, -99999.0, -999999.0, 9.9e37, -9.9e37, 9.91e37)
MARKS = {codecs.BOM_UTF8: "utf-8-sig", codecs.BOM_UTF16_LE: "utf-16", codecs.BOM_UTF16_BE: "utf-16"}
ASIAN = re.compile(r"[\u3040-\u30ff\u4e00-\u9fff]")
LINE_END = re.compile(r"\n\r(?!\n)|(\r+)(\n?)")  # OceanView ends its header lines with LF CR
DOS_END = "\x1a"  # what programs of DOS write behind a text, up to the end of its block
CONTROL = re.compile(r"[\x00-\x08\x0e-\x1f]")
REPORTED = 10  # faults of a kind that are named before the rest is only counted
LONGEST_LINE = 5_000_000  # characters; a header of 50 000 wavelengths has a tenth of that


class Refusal(ContractError):
    """Files that cannot be read; `messages` holds one clear sentence per fault."""

    def __init__(self, messages):
        self.messages = list(messages)
        super().__init__("\n".join(self.messages))


def fault(path, what, remedy, line=None):
    """The sentence for one fault: file, line, what is wrong, what to do."""
    where = f"{path}, line {line}" if line else f"{path}"
    return printable(f"{where}: {what}; {remedy}").replace("\n", "\\n")


def refuse(path, what, remedy, line=None):
    """Raise the Refusal of one fault (see `fault`)."""
    raise Refusal([fault(path, what, remedy, line)])


def refuse_all(path, faults):
    """Raise the Refusal of faults, if there are any: the first ones by name, the number of the others."""
    if faults:
        more = [f"{path}: {len(faults) - REPORTED} more faults like these"] if len(faults) > REPORTED else []
        raise Refusal(faults[:REPORTED] + more)


def checked(dataset, contract, path):
    """A dataset made from a file, labelled; Refusal where it breaches its contract."""
    try:
        return check(label(dataset, contract), contract)
    except ContractError as reason:
        raise Refusal([f"{path}: {reason}"]) from None


def regular_file(path, limit):
    """Return `path` if it is a plain file of 1 to `limit` bytes; else Refusal (see `foreign.unfit`)."""
    if found := unfit(path, limit):
        refuse(path, *found)
    return Path(path)


def read_lines(path, limit):
    """Lines of a text file, without line ends, and whether the last one is ended by one.

    UTF-8 and UTF-16, with a byte order mark or without, else Windows-1252 letter by letter (Latin-1) or that
    of Japan: the old acquisition programs write in that of their country. Numbers are ASCII in all of them. A
    gzip file is unpacked. Refusal if the file is absent, not plain, empty, larger than `limit` [byte], or not
    text.
    """
    path = regular_file(path, limit)
    try:
        content = path.read_bytes()
        if content.startswith(GZIP):
            content = _unpacked(path, content, limit)
    except OSError as reason:
        refuse(path, f"cannot be read ({reason})", "check the access rights")
    for begin, (kind, remedy) in BINARY.items():
        if content.startswith(begin):
            if remedy.startswith("it must end in") and path.suffix.lower() in remedy.split(" in ")[1]:
                remedy = "signals against time are read from such a file, spectra are not: save them as text"
            refuse(path, f"is {kind}, not text", remedy)
    encoding = next((name for mark, name in MARKS.items() if content.startswith(mark)), None)
    for first, unmarked in enumerate(("utf-16-be", "utf-16-le")):  # without its mark
        if (
            encoding is None
            and content[1:]
            and content[first:2000:2].count(0) > 0.8 * len(content[first:2000:2])
        ):
            encoding = unmarked
    try:
        words = content.decode(encoding or "utf-8")
    except UnicodeDecodeError:
        if encoding:
            what = (
                "holds binary data, not text" if "\0" in content[:999].decode("latin-1") else "is broken text"
            )
            refuse(path, f"{what} (tried {encoding})", "export the data as text, UTF-8")
        words = _of_a_country(content)
    if words.endswith("\0") and not CONTROL.search(words.rstrip("\0")):
        what = f"ends in {len(words) - len(words.rstrip(chr(0)))} zero bytes, as after a loss of power"
        refuse(path, what, "the samples there are lost; remove the bytes if the test is before them")
    if words.endswith(DOS_END):
        words = words.rstrip(DOS_END).removesuffix("\n") + "\n"  # it says that nothing is cut off
    if CONTROL.search(words):
        refuse(path, "holds binary data, not text", "export the data as text")
    if "\r" in words:
        words = LINE_END.sub(lambda end: "\n" * (1 if end[2] or not end[1] else len(end[1])), words)
    lines = words.split("\n")
    longest = max(map(len, lines))
    if longest > LONGEST_LINE:
        refuse(path, f"holds a line of {longest} characters", "export it with one sample per line")
    ended = lines[-1] == ""
    return (lines[:-1] if ended else lines), ended


def _unpacked(path, content, limit):
    unpacking = zlib.decompressobj(wbits=31)
    try:
        words = unpacking.decompress(content, limit + 1)
    except zlib.error as reason:
        refuse(path, f"is a broken gzip file ({reason})", "copy it again")
    if len(words) > limit:
        refuse(path, f"holds more than {limit} bytes when unpacked", "cut it to the test")
    if not unpacking.eof:
        refuse(path, "is a gzip file that is cut off", "copy it again")
    return words


def _of_a_country(content):
    """Text of a Japanese Windows if it reads as such and Latin-1 makes no letters of it, else Latin-1."""
    words = content.decode("latin-1")
    if any("\x80" <= letter < "\xa0" for letter in words):
        try:
            japanese = content.decode("cp932")
        except UnicodeDecodeError:
            return words
        if ASIAN.search(japanese):
            return japanese
    return words


def require_end(path, lines, ended):
    """Refuse a table whose last line has no line end: its last number may have lost digits.

    Not where the numbers that end the lines before, up to `ALIKE`, have as many digits: a lost one would
    show.
    """
    if not ended and not _ends_alike(lines[-ALIKE - 1 :]):
        refuse(
            path,
            "the last line has no end and may be cut off",
            "copy the file again, or add a line end if it is complete",
            len(lines),
        )


def _ends_alike(lines):
    """Whether lines end in as many digits as the last, behind the same sign; of less than three nobody knows.

    Names and remarks, which end in no number, are left out.
    """
    *before, last = (LAST_DIGITS.search(line.rstrip()) for line in lines)
    ends = [(end[1], len(end[2])) for end in (*before, last) if end]
    return last is not None and len(ends) > 3 and len(set(ends)) == 1


def missing(word):
    """Whether a cell holds no sample: empty, or a word that says so (see `MISSING`)."""
    return MISSING.fullmatch(word.strip().lower()) is not None


def number(word, decimal=".", thousands=False):
    """The number in a cell: float, NaN for a cell that says 'missing', None for anything else.

    `decimal` None: a comma is the decimal sign where the cell holds one. `thousands`: the decimal sign is
    known, so that the other one before three digits parts thousands ('1,234').

    Strict on purpose: no underscores, no foreign digits, no thousands but those that nothing else can be
    (`GROUPED`: 1,234.5). What meters show instead of a number (`MISSING`: OVER, 1.#INF) is no sample.
    """
    word = word.strip().replace("\u2212", "-")  # the minus of Scandinavian systems
    decimal = decimal or ("," if "," in word else ".")
    if decimal == "." and NUMBER.fullmatch(word):
        value = float(word.replace("d", "e").replace("D", "e"))
        return value if math.isfinite(value) else None
    if missing(word):
        return math.nan
    if word[0] in "+-":  # '+   10.6'
        word = word[0] + word[1:].lstrip()
    if GROUPED[decimal].fullmatch(word) or (thousands and ONE_GROUP[decimal].fullmatch(word)):
        word = "".join(sign for sign in word if sign.isdigit() or sign in ("+-" + decimal))
    if decimal != ".":
        if "." in word:
            return None
        word = word.replace(decimal, ".")
    if not NUMBER.fullmatch(word):
        return None
    value = float(word.replace("d", "e").replace("D", "e"))
    return value if math.isfinite(value) else None
