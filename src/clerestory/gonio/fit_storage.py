"""Storage of fitted measurements in NetCDF.

The file is NetCDF-4 with one group per scattering function. A group contains the mesh,
the lobes of all mesh vertices and the matches of all transport plans, each concatenated
into one array. A SHA-256 checksum follows the data, as in files of transfer matrices.
"""

import io
from collections.abc import Sequence
from pathlib import Path
from typing import Any, get_args

import h5netcdf  # type: ignore[import-untyped]
import h5py
import numpy as np

from clerestory.bsdf.scattering_function import Function
from clerestory.errors import InputError
from clerestory.files import read_bytes, replace_file
from clerestory.gonio.fitted_measurement import Fitted
from clerestory.gonio.incident_mesh import Mesh
from clerestory.gonio.interpolant import Interpolant
from clerestory.gonio.lobe_fitting import FitOptions
from clerestory.gonio.lobes import Lobes
from clerestory.gonio.optimal_transport import Plan
from clerestory.gonio.symmetry import SYMMETRIES
from clerestory.gonio.transport_network import Network
from clerestory.matrix.netcdf import SEAL_LENGTH, seal

_FORMAT = "Clerestory scattering interpolant 1"


def write_fits(path: str | Path, fits: Sequence[Fitted]) -> None:
    """Write fitted scattering functions to a file."""
    buffer = io.BytesIO()
    with h5netcdf.File(buffer, "w") as file:
        file.attrs["format"] = _FORMAT
        for fit in fits:
            group = file.create_group(f"{fit.channel}_{fit.function}")
            group.attrs["function"] = fit.function
            group.attrs["channel"] = fit.channel
            group.attrs["name"] = fit.name
            group.attrs["symmetry"] = fit.interpolant.symmetry
            group.attrs["most_lobes"] = fit.options.lobes
            group.attrs["smoothing"] = fit.options.smoothing
            _write(group, fit.interpolant.network)
    with replace_file(path) as stream:
        stream.write(buffer.getvalue())
        stream.write(seal(buffer.getbuffer()))


def read_fits(path: str | Path) -> tuple[Fitted, ...]:
    """Read the fitted scattering functions of a file written by `write_fits`."""
    data = read_bytes(path)
    if data[-SEAL_LENGTH:] != seal(memoryview(data)[:-SEAL_LENGTH]):
        raise InputError(
            "the file is damaged or not written by this package; a file written by"
            " `clerestory gonio fit` expected",
            file=path,
        )
    try:
        with h5py.File(io.BytesIO(data), "r") as file:
            if file.attrs.get("format") != _FORMAT:
                raise InputError(f"another file format; {_FORMAT!r} expected")
            return tuple(_fitted(file[name]) for name in sorted(file))
    except InputError as error:
        raise InputError(error.message, file=path) from error
    except Exception as error:  # HDF5 raises many kinds of exception for damaged files
        reason = " ".join(str(error).split()) or type(error).__name__
        raise InputError(
            f"damaged or not NetCDF-4 ({reason[:120]}); a fitted measurement expected",
            file=path,
        ) from error


def _write(group: Any, network: Network) -> None:
    # Write the mesh, lobes and transport plans of one scattering function
    mesh, lobes, plans = network.mesh, network.lobes, network.plans
    for name, dimensions, parts in (
        ("vertices", ("vertex", "axis"), [mesh.vertices]),
        ("triangles", ("triangle", "corner"), [mesh.triangles]),
        ("edges", ("edge", "end"), [mesh.edges]),
        ("rim", ("edge",), [mesh.rim.astype(np.int8)]),
        ("quadrant", ("plane",), [network.quadrant]),
        ("lobe_centre", ("lobe", "axis"), [part.centre for part in lobes]),
        ("lobe_radius_rad", ("lobe",), [part.radius for part in lobes]),
        ("lobe_flux", ("lobe",), [part.flux for part in lobes]),
        ("lobes_of_vertex", ("vertex",), [np.array([len(part) for part in lobes])]),
        ("move_source", ("move",), [plan.source for plan in plans]),
        ("move_target", ("move",), [plan.target for plan in plans]),
        ("move_sent", ("move",), [plan.sent for plan in plans]),
        ("move_received", ("move",), [plan.received for plan in plans]),
        ("moves_of_edge", ("edge",), [np.array([len(plan.sent) for plan in plans])]),
        ("fading", ("edge_start_lobe",), [plan.fading for plan in plans]),
        ("rising", ("edge_end_lobe",), [plan.rising for plan in plans]),
    ):
        array = np.ascontiguousarray(np.concatenate(parts))
        for dimension, size in zip(dimensions, array.shape, strict=True):
            if dimension not in group.dimensions:
                group.dimensions[dimension] = size
        if array.size:
            group.create_variable(name, dimensions, data=array, fletcher32=True)


def _fitted(group: h5py.Group) -> Fitted:
    attributes = group.attrs
    function, symmetry = str(attributes["function"]), str(attributes["symmetry"])
    if function not in get_args(Function) or symmetry not in SYMMETRIES:
        raise InputError(
            f"function {function!r} with symmetry {symmetry!r}; known names expected"
        )
    smoothing = float(np.ravel(attributes["smoothing"])[0])
    return Fitted(
        Interpolant(_network(group), symmetry),
        function,  # type: ignore[arg-type]
        str(attributes["channel"]),
        str(attributes["name"]),
        FitOptions(
            lobes=int(np.ravel(attributes["most_lobes"])[0]), smoothing=smoothing
        ),
    )


def _network(group: h5py.Group) -> Network:
    def array(name: str) -> np.ndarray:
        return np.asarray(group[name][...])

    triangles = array("triangles") if "triangles" in group else np.zeros((0, 3), int)
    edges = array("edges")
    mesh = Mesh(array("vertices"), triangles, edges, array("rim").astype(bool))
    count = array("lobes_of_vertex")
    lobes = tuple(
        Lobes(*parts)
        for parts in zip(
            *(
                np.split(array(name), np.cumsum(count)[:-1])
                for name in ("lobe_centre", "lobe_radius_rad", "lobe_flux")
            ),
            strict=True,
        )
    )
    limits = np.cumsum(array("moves_of_edge"))[:-1]
    moves = [
        np.split(array(name), limits) if name in group else [np.zeros(0)] * len(edges)
        for name in ("move_source", "move_target", "move_sent", "move_received")
    ]
    ends = [
        np.split(array(name), np.cumsum(count[edges[:, side]])[:-1])
        for side, name in enumerate(("fading", "rising"))
    ]
    plans = tuple(
        Plan(source.astype(int), target.astype(int), sent, received, fading, rising)
        for source, target, sent, received, fading, rising in zip(
            *moves, *ends, strict=True
        )
    )
    return Network(mesh, lobes, plans, array("quadrant"))
