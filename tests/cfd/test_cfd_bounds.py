"""Small files that claim, unpack to or point at more than they hold: refused by name, within bounds."""

import base64
import lzma
import os
import shutil
import struct
import zlib

import cfd_samples as samples
import h5py
import numpy as np
import pytest
import yaml
from judge import judge, require_refused

NAMES = {"temperature": {"name": "Temperature", "unit": "K"}, "pressure": {"name": "Pressure", "unit": "Pa"}}
BLOCK, BLOCKS = 1 << 24, 50  # 0.8 GB of zeros, more than any small file may ask for


def refused(folder, name, *words, mapping=None, mesh=()):
    (folder / "m.yaml").write_text(yaml.safe_dump(mapping or samples.settings("planar")))
    ending = judge(
        ["sightline", folder / name, "--map", folder / "m.yaml", "--out", folder / "o.nc", *mesh], folder
    )
    require_refused(ending, name, *words)
    assert not (folder / "o.nc").exists()


def tecplot(folder, old, new):
    text = samples.tecplot_fepoint(*samples.triangles())
    assert old in text
    (folder / "f.plt").write_text(text.replace(old, new, 1))


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("1.0 ", "400000000*1.0 ", "400000318 stand there"),
        ("1.0 ", "9" * 400 + "*1.0 ", "is not a number"),
        ("F=FEPOINT", "F=FEBLOCK VARLOCATION=([1-400000000]=CELLCENTERED)", "variable '1-400000000' of 5"),
        ("F=FEPOINT", "F=FEBLOCK VARLOCATION=([-3]=CELLCENTERED)", "variable '-3' of 5"),
        ("F=FEPOINT", "F=FEBLOCK VARLOCATION=([3-1]=CELLCENTERED)", "variable '3-1' of 5"),
        ("F=FEPOINT", "F=FEBLOCK VARLOCATION=([\u00b2]=CELLCENTERED)", "variable '²' of 5"),
        ("F=FEPOINT", "F=FEBLOCK VARLOCATION=([" + "1," * 9000 + "1]=CELLCENTERED)", "has 18018 characters"),
        ("N=35", "N=\u00b2", "has no N= with a number"),
        ("N=35", "N=" + "9" * 15, "999999999999999 nodes"),
        ("ZONE ", "ZONE " + "a" * 200_000 + " ", "has no N= with a number"),
    ],
    ids=["repeats", "digits", "span", "negative", "falling", "square", "long", "count", "nodes", "flood"],
)
def test_tecplot_headers_that_ask_for_too_much(tmp_path, old, new, words):
    if words.startswith("has no N") and "aaa" in new:
        old, new = "N=35", "a" * 200_000
    tecplot(tmp_path, old, new)
    refused(tmp_path, "f.plt", words)


def test_an_ordered_zone_of_more_nodes_than_numbers_can_count(tmp_path):
    head = 'VARIABLES = "x" "y" "T" "p"\nZONE I=4294967296, J=4294967296, F=POINT\n0 0 1 1\n'
    (tmp_path / "f.dat").write_text(head)
    refused(tmp_path, "f.dat", "73786976294838206464 numbers")


def test_infinite_numbers_of_a_tecplot_file_are_named_without_a_warning(tmp_path):
    text = samples.tecplot_fepoint(*samples.triangles())
    lines = text.splitlines()
    lines[-1] = "1 inf nan"
    (tmp_path / "f.plt").write_text("\n".join(lines) + "\n")
    refused(tmp_path, "f.plt", "names node inf of 35")


def vtu(folder, compressor, packed, kind=9, size=BLOCK * BLOCKS):
    head = struct.pack("<4I", 1, size & 0xFFFFFFFF, 0, len(packed))
    data = base64.b64encode(head).decode() + base64.b64encode(packed).decode()
    one = '<DataArray type="{}" {} format="{}">{}</DataArray>'
    cells = "".join(
        one.format("Int64", f'Name="{name}"', "ascii", words)
        for name, words in (("connectivity", "0 1 2 3"), ("offsets", "4"), ("types", str(kind)))
    )
    points = one.format("Float64", 'NumberOfComponents="3"', "binary", data)
    (folder / "f.vtu").write_text(
        '<?xml version="1.0"?><VTKFile type="UnstructuredGrid" version="0.1" byte_order="LittleEndian"'
        f' header_type="UInt32" compressor="{compressor}"><UnstructuredGrid>'
        f'<Piece NumberOfPoints="4" NumberOfCells="1"><Points>{points}</Points><Cells>{cells}</Cells>'
        "</Piece></UnstructuredGrid></VTKFile>"
    )


@pytest.mark.parametrize(
    ("compressor", "machine"),
    [
        ("vtkZLibDataCompressor", lambda: zlib.compressobj(6)),
        ("vtkLZMADataCompressor", lambda: lzma.LZMACompressor(preset=0)),
    ],
)
def test_compressed_blocks_of_a_vtu_file_that_unpack_to_a_gigabyte(tmp_path, compressor, machine):
    packer, zeros = machine(), bytes(BLOCK)
    packed = b"".join(packer.compress(zeros) for _ in range(BLOCKS)) + packer.flush()
    vtu(tmp_path, compressor, packed)
    refused(tmp_path, "f.vtu", "asks for far more memory than a file of its size can need")


def test_structured_points_of_a_vtk_file_that_nobody_stored(tmp_path):
    (tmp_path / "f.vtk").write_text(
        "# vtk DataFile Version 3.0\nx\nASCII\nDATASET STRUCTURED_POINTS\nDIMENSIONS 2000 2000 2000\n"
        "ORIGIN 0 0 0\nSPACING 1 1 1\n"
    )
    refused(tmp_path, "f.vtk", "asks for far more memory")


@pytest.mark.parametrize("kind", [43, 200])
def test_vtk_cells_of_unknown_kind_are_refused_and_not_left_out(tmp_path, kind):
    vtu(tmp_path, "vtkZLibDataCompressor", zlib.compress(bytes(96)), kind=kind, size=96)
    refused(tmp_path, "f.vtu", f"holds cells of a kind that is not read (type {kind})", "Tetrahedralize")


@pytest.fixture
def cgns(tmp_path):
    shutil.copy(samples.FILES / "structured.cgns", tmp_path / "f.cgns")
    with h5py.File(tmp_path / "f.cgns", "a") as file:
        yield tmp_path, file


def test_a_cgns_array_that_claims_gigabytes(cgns):
    folder, file = cgns
    node = file["/Base/torch/GridCoordinates/CoordinateX"]
    del node[" data"]
    node.create_dataset(" data", shape=(10**9,), dtype="f8", chunks=(10**6,), compression="gzip")
    file.close()
    refused(
        folder, "f.cgns", "says that it holds 8000 MB", mapping=samples.settings("planar", variables=NAMES)
    )


@pytest.mark.parametrize("way", ["storage", "link", "virtual", "soft"])
def test_a_cgns_file_that_brings_bytes_of_another_file(cgns, way):
    folder, file = cgns
    node = file[file.visit(lambda name: name if name.endswith("Temperature") else None)]
    shape = node[" data"].shape
    secret = np.linspace(2000, 3000, int(np.prod(shape)))
    (folder / "secret").write_bytes(secret.astype("<f8").tobytes())
    with h5py.File(folder / "other.h5", "w") as other:
        other["x"] = secret.reshape(shape)
    del node[" data"]
    if way == "storage":
        node.create_dataset(
            " data", shape=shape, dtype="<f8", external=[(str(folder / "secret"), 0, secret.nbytes)]
        )
    elif way == "link":
        node[" data"] = h5py.ExternalLink("other.h5", "/x")
    elif way == "virtual":
        layout = h5py.VirtualLayout(shape=shape, dtype="<f8")
        layout[...] = h5py.VirtualSource("other.h5", "x", shape=shape)
        node.create_virtual_dataset(" data", layout)
    else:
        file["way"] = h5py.ExternalLink("other.h5", "/")
        node[" data"] = h5py.SoftLink("/way/x")
    file.close()
    refused(folder, "f.cgns", "another file", mapping=samples.settings("planar", variables=NAMES))


@pytest.mark.parametrize("line", ["5 0 1 \u00b2 0", "\u00b2 0 1 2 0", "5 0 1 -1 0"])
def test_su2_cells_whose_numbers_are_none(tmp_path, line):
    mesh = f"NDIME= 2\nNELEM= 1\n{line}\nNPOIN= 3\n0 0 0\n1 0 1\n0 1 2\nNMARK= 0\n"
    (tmp_path / "mesh.su2").write_text(mesh)
    (tmp_path / "f.csv").write_text('"PointID","x","y","p","T"\n0,0,0,1,2\n1,1,0,1,2\n2,0,1,1,2\n')
    mapping = samples.settings("planar", format="su2")
    (tmp_path / "m.yaml").write_text(yaml.safe_dump(mapping))
    ending = judge(
        ["sightline", tmp_path / "f.csv", "--map", tmp_path / "m.yaml", "--out", tmp_path / "o.nc"]
        + ["--mesh", tmp_path / "mesh.su2"],
        tmp_path,
    )
    require_refused(ending, "mesh.su2, line 3", "is no cell")


@pytest.mark.parametrize(
    "flood", ["a" + " " * 300_000 + "b", "\r" * 1_000_000, "1 " * 500_000, '"' * 400_000]
)
def test_floods_of_one_character_do_not_hang(tmp_path, flood):
    (tmp_path / "f.csv").write_bytes(b"x,y\n" + flood.encode() + b"x\n")
    refused(tmp_path, "f.csv")


@pytest.mark.parametrize("kind", ["device", "pipe", "circle", "nowhere", "folder"])
def test_only_plain_files_are_opened(tmp_path, kind):
    path = tmp_path / "f.vtu"
    if kind == "device":
        path.symlink_to("/dev/zero")
    elif kind == "pipe":
        os.mkfifo(path)
    elif kind == "folder":
        path.mkdir()
    else:
        path.symlink_to("f.vtu" if kind == "circle" else "none.vtu")
    words = "a link that leads to no file" if kind in ("circle", "nowhere") else "not a plain file"
    refused(tmp_path, "f.vtu", words)


def test_a_message_quotes_no_more_of_a_file_than_a_reader_can_take_in(tmp_path):
    """meshio repeats an unknown data type of any length; found by 10 000 damaged files."""
    text = (samples.FILES / "mixed_ascii.vtk").read_bytes()
    (tmp_path / "f.vtk").write_bytes(text.replace(b"ASCII", b"1" * 30_000 + b"ASCII", 1))
    (tmp_path / "m.yaml").write_text(yaml.safe_dump(samples.settings("planar")))
    words = ["sightline", tmp_path / "f.vtk", "--map", tmp_path / "m.yaml", "--out", tmp_path / "o.nc"]
    ending = judge(words, tmp_path)
    require_refused(ending, "f.vtk", "cannot be read as VTK")
    assert len(ending.message) < 1000
