"""Storage of fitted measurements in NetCDF.

The file is NetCDF-4 with one group per scattering function. A group contains the mesh,
the lobes of all mesh vertices and the matches of all transport plans, each concatenated
into one array. A SHA-256 checksum follows the data, as in files of transfer matrices.
"""

import io
from collections.abc import Sequence
from pathlib import Path
from typing import Any, cast

import h5netcdf  # type: ignore[import-untyped]
import h5py
import numpy as np

from clerestory.bsdf.scattering_function import FUNCTIONS, Function
from clerestory.checks import one_of, require
from clerestory.errors import InputError, located
from clerestory.escaping import file_stem, printable
from clerestory.files import read_bytes, replace_file
from clerestory.gonio.fitted_measurement import Fitted
from clerestory.gonio.incident_mesh import Mesh
from clerestory.gonio.interpolant import Interpolant
from clerestory.gonio.lobe_fitting import FitOptions
from clerestory.gonio.lobes import Lobes
from clerestory.gonio.optimal_transport import Network, Plan
from clerestory.gonio.symmetry import SYMMETRIES, Symmetry
from clerestory.matrix.netcdf import SEAL_LENGTH, seal

_FORMAT = "Clerestory scattering interpolant 1"

# Attributes of `Lobes` and `Plan`, by name of the variable in the file
_LOBES = {"lobe_centre": "centre", "lobe_radius_rad": "radius", "lobe_flux": "flux"}
_MATCHES = {
    "move_source": "source",
    "move_target": "target",
    "move_sent": "sent",
    "move_received": "received",
}


def write_fits(path: str | Path, fits: Sequence[Fitted]) -> None:
    """Write fitted scattering functions to a file."""
    buffer = io.BytesIO()
    with h5netcdf.File(buffer, "w") as file:
        file.attrs["format"] = _FORMAT
        for fit in fits:
            group = file.create_group(f"{file_stem(fit.channel)}_{fit.function}")
            group.attrs["function"] = fit.function
            group.attrs["channel"] = printable(fit.channel)
            group.attrs["name"] = printable(fit.name)
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
    require(
        data[-SEAL_LENGTH:] == seal(memoryview(data)[:-SEAL_LENGTH]),
        "the file is damaged or not written by this package; a file written by"
        " `clerestory gonio fit` expected",
        file=path,
    )
    try:
        with located(file=path), h5py.File(io.BytesIO(data), "r") as file:
            one_of(file.attrs.get("format"), "file format", choices=(_FORMAT,))
            return tuple(_fitted(file[name]) for name in sorted(file))
    except InputError:
        raise
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
        *(
            (name, ("lobe", "axis"), [getattr(part, field) for part in lobes])
            for name, field in _LOBES.items()
        ),
        ("lobes_of_vertex", ("vertex",), [np.array([len(part) for part in lobes])]),
        *(
            (name, ("move",), [getattr(plan, field) for plan in plans])
            for name, field in _MATCHES.items()
        ),
        ("moves_of_edge", ("edge",), [np.array([len(plan.sent) for plan in plans])]),
        ("fading", ("edge_start_lobe",), [plan.fading for plan in plans]),
        ("rising", ("edge_end_lobe",), [plan.rising for plan in plans]),
    ):
        array = np.ascontiguousarray(np.concatenate(parts))
        axes = dimensions[: array.ndim]
        for dimension, size in zip(axes, array.shape, strict=True):
            if dimension not in group.dimensions:
                group.dimensions[dimension] = size
        if array.size:
            group.create_variable(name, axes, data=array, fletcher32=True)


def _fitted(group: h5py.Group) -> Fitted:
    attributes = group.attrs
    function, symmetry = str(attributes["function"]), str(attributes["symmetry"])
    one_of(function, "scattering function", choices=FUNCTIONS)
    one_of(symmetry, "symmetry", choices=SYMMETRIES)
    lobes, smoothing = (
        np.ravel(attributes[name])[0] for name in ("most_lobes", "smoothing")
    )
    return Fitted(
        Interpolant(_network(group), cast(Symmetry, symmetry)),
        cast(Function, function),
        str(attributes["channel"]),
        str(attributes["name"]),
        FitOptions(lobes=int(lobes), smoothing=float(smoothing)),
    )


def _split(values: np.ndarray, count: np.ndarray) -> list[np.ndarray]:
    return np.split(values, np.cumsum(count)[:-1])


def _network(group: h5py.Group) -> Network:
    def array(name: str) -> np.ndarray:
        return np.asarray(group[name][...])

    triangles = array("triangles") if "triangles" in group else np.zeros((0, 3), int)
    edges = array("edges")
    mesh = Mesh(array("vertices"), triangles, edges, array("rim").astype(bool))
    count = array("lobes_of_vertex")
    parts = [_split(array(name), count) for name in _LOBES]
    lobes = tuple(Lobes(*values) for values in zip(*parts, strict=True))
    matches = [
        _split(array(name), array("moves_of_edge"))
        if name in group
        else [np.zeros(0)] * len(edges)
        for name in _MATCHES
    ]
    ends = [
        _split(array(name), count[edges[:, side]])
        for side, name in enumerate(("fading", "rising"))
    ]
    plans = tuple(
        Plan(source.astype(int), target.astype(int), *fluxes)
        for source, target, *fluxes in zip(*matches, *ends, strict=True)
    )
    return Network(mesh, lobes, plans, array("quadrant"))
