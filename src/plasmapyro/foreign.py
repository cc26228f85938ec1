"""Files that others wrote: which may be opened, what they may refer to, how much memory one may take."""

from contextlib import contextmanager
from pathlib import Path

import yaml

try:
    import resource
except ImportError:  # Windows sets no such limits
    resource = None

ANY_FILE = 500_000_000  # [byte] of memory that reading any file may take, ...
PER_BYTE = 15  # ... and so many for each of its own: words of a text take some ten, unpacked blocks a few
SMALL = 100_000_000  # [byte] that any file may claim to hold
LARGEST_RATIO = 20  # of what is claimed to the size of a larger file; real measurements pack to a tenth
HDF5_SIGNATURE = b"\x89HDF"
SHOWN = 60  # characters of a cell that a message quotes
TOLD = 300  # characters of what a library says of a file
DEEPEST = 12  # nested levels of a YAML file
PACKED = "no measurement packs so well, or it is damaged: save it again without compression"


def quote(words):
    """A piece of a file, shortened and printable, for a message."""
    words = str(words)
    return repr(words if len(words) <= SHOWN else words[:SHOWN] + "...")


def told(reason):
    """What a library says of a file, on one line and shortened: it may quote the file at any length."""
    words = " ".join(str(reason).split()) or type(reason).__name__
    return words if len(words) <= TOLD else words[:TOLD] + "..."


def printable(words):
    """A message without the control characters that a file may have brought into it; its lines stay."""
    return "".join(c if c.isprintable() or c == "\n" else c.encode("unicode_escape").decode() for c in words)


def unfit(path, largest):
    """What speaks against reading a path, and what to do; None for a plain file of 1 to `largest` bytes.

    A pipe or a device would block or never end, so nothing but plain files is opened.
    """
    path = Path(path)
    try:
        if path.is_symlink() and not path.exists():
            return "is a link that leads to no file", "copy the file itself"
        if not path.exists():
            return "no such file", "check the name, upper and lower case included"
        if not path.is_file():
            return "not a plain file", "give the name of a file"
        size = path.stat().st_size
    except (OSError, ValueError) as reason:
        return f"cannot be opened ({reason})", "check the name and the access rights"
    if size == 0:
        return "is empty", "copy it again"
    if size > largest:
        return (
            f"is {size / 1e6:.3g} MB large, the limit is {largest / 1e6:.3g} MB",
            "split it, or cut it to the part that is needed",
        )
    return None


class Strict:
    """Makes a loader of PyYAML refuse aliases, of which a short file can make a huge one, a key that is given
    twice, and deep nesting."""

    depth = 0

    def compose_node(self, parent, index):
        alias, mark = self.check_event(yaml.AliasEvent), self.peek_event().start_mark
        self.depth += 1
        if alias or self.depth > DEEPEST:
            what = "aliases (*name) are not taken; write the value out" if alias else "nested too deeply"
            raise yaml.MarkedYAMLError(problem=what, problem_mark=mark)
        node = super().compose_node(parent, index)
        self.depth -= 1
        return node

    def construct_mapping(self, node, deep=False):
        known = set()
        for key, _ in node.value:
            word = repr(self.construct_object(key, deep=True))
            if word in known:
                raise yaml.MarkedYAMLError(problem=f"key {word} is given twice", problem_mark=key.start_mark)
            known.add(word)
        return super().construct_mapping(node, deep)


@contextmanager
def memory_for(path):
    """Let a block take the memory that a file of this size can need, and no more.

    MemoryError out of the block, at the allocation that goes beyond. Where the system does not say what the
    process holds (not Linux) nothing is limited.
    """
    try:
        pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[0])
    except OSError:
        pages = None
    if None in (pages, resource):
        yield
        return
    soft, hard = resource.getrlimit(resource.RLIMIT_AS)
    most = pages * resource.getpagesize() + ANY_FILE + PER_BYTE * Path(path).stat().st_size
    known = [most, *(limit for limit in (soft, hard) if limit != resource.RLIM_INFINITY)]
    resource.setrlimit(resource.RLIMIT_AS, (min(known), hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_AS, (soft, hard))


def claim(path, size):
    """What is wrong with a file that says it holds `size` bytes, or None."""
    own = Path(path).stat().st_size
    if size <= max(SMALL, LARGEST_RATIO * own):
        return None
    return f"says that it holds {size / 1e6:.0f} MB, and has {own / 1e6:.3g} MB itself"


def elsewhere(path):
    """Where an HDF5 file (netCDF-4, CGNS) refers to other files, or claims more than it can hold.

    What is wrong and what to do; None also for a file that is not HDF5. HDF5 follows such references without
    a word: a file of others would bring bytes of this machine along. OSError, RuntimeError from h5py, for a
    damaged file.
    """
    import h5py  # 0.1 s, which only files of others cost

    with open(path, "rb") as file:
        if file.read(4) != HDF5_SIGNATURE:
            return None
    with h5py.File(path, "r", locking=False) as file:  # only looked at; some servers know no locks
        # First the links themselves: to look at what one leads to opens the other file.
        linked = file.visititems_links(
            lambda name, link: name if isinstance(link, h5py.ExternalLink) else None
        )
        if linked is not None:
            return f"refers to another file ({linked!r})", "save all data in one file"
        sizes = []

        def look(name, node):
            if not isinstance(node, h5py.Dataset):
                return None
            sizes.append(node.nbytes)
            return name if node.is_virtual or node.external else None

        outside = file.visititems(look)
    if outside is not None:
        return f"keeps data in another file ({outside!r})", "save all data in one file"
    found = claim(path, sum(sizes))
    return (found, PACKED) if found else None
