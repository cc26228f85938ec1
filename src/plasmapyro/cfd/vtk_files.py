"""VTK files, legacy and XML, of unstructured and structured grids."""

from contextlib import contextmanager

import meshio

from plasmapyro.cfd.grid import AXES, OTHER_CELLS, Zone
from plasmapyro.foreign import told
from plasmapyro.readers.text import refuse, regular_file

LARGEST = 4_000_000_000  # [byte]
READERS = {".vtu": meshio.vtu.read, ".vtk": meshio.vtk.read}
UNREAD = ("pixel", "voxel")  # cells of image data that meshio does not know


def read(path):
    """Zones of a .vtu or .vtk file: one, with the coordinates x, y, z; vectors become name_x, name_y, name_z.

    Refusal: another kind of VTK file, or one that is broken.
    """
    path = regular_file(path, LARGEST)
    if path.suffix.lower() not in READERS:
        refuse(
            path, f"is no file that is read ({path.suffix})", "save it as .vtu (unstructured grid, one file)"
        )
    try:
        with _nothing_left_out():
            mesh = READERS[path.suffix.lower()](str(path))
    except MemoryError:
        raise
    except Exception as reason:  # whatever a parser of other people's bytes runs into
        if isinstance(reason, KeyError) and reason.args[0] in UNREAD:
            refuse(path, f"holds cells of kind {reason.args[0]}, which are not read", OTHER_CELLS)
        words = told(reason)
        if "meshio cannot handle" in words:
            kind = words.partition("handle")[2].strip(" .")
            refuse(path, f"holds cells of a kind that is not read {kind}", OTHER_CELLS)
        refuse(path, f"cannot be read as VTK ({words})", "it may be cut off; save it again as .vtu")
    points = {name: mesh.points[:, k] for k, name in enumerate(AXES[: mesh.points.shape[1]])}
    cells = [(block.type, block.data) for block in mesh.cells]
    zone = Zone(path.stem, {**_scalars(mesh.point_data), **points}, cells)
    for name in mesh.cell_data:
        parts = [_scalars({name: part}) for part in mesh.cell_data[name]]
        for key in parts[0] if parts else ():
            zone.cell_data[key] = [part[key] for part in parts]
    return [zone]


@contextmanager
def _nothing_left_out():
    """Make meshio stop where it would say a word and leave out cells or arrays that it does not know."""

    def stop(words, **_):
        raise ValueError(words)

    modules = (meshio._vtk_common, meshio.vtu._vtu)
    before = [module.warn for module in modules]
    try:
        for module in modules:
            module.warn = stop
        yield
    finally:
        for module, function in zip(modules, before, strict=True):
            module.warn = function


def _scalars(data):
    """Columns of vectors as fields of their own."""
    found = {}
    for name, values in data.items():
        if values.ndim == 1 or values.shape[1] == 1:
            found[name] = values.reshape(len(values))
        elif values.ndim == 2:
            for k in range(values.shape[1]):
                suffix = AXES[k] if values.shape[1] <= 3 else str(k)
                found[f"{name}_{suffix}"] = values[:, k]
    return found
