"""`clerestory import`: models of other programs as files of ours."""

from pathlib import Path
from typing import Annotated

import typer

from clerestory.cli.options import Quiet
from clerestory.errors import InputError
from clerestory.formats.gltf import read_gltf
from clerestory.formats.hbjson import read_hbjson
from clerestory.formats.obj import read_obj
from clerestory.radiance.material_map import MaterialMap, read_material_map
from clerestory.scene.model import Scene
from clerestory.study.model_import import Written, write_honeybee_model, write_scene

_HONEYBEE, _MESHES = (".hbjson", ".json"), (".obj", ".gltf", ".glb")


def import_model(
    model: Annotated[
        Path,
        typer.Argument(metavar="MODEL", help="A .hbjson, .obj, .gltf or .glb file."),
    ],
    output: Annotated[
        Path, typer.Option("--output", "-o", help="Folder for the files.")
    ],
    weather: Annotated[
        Path | None,
        typer.Option("--weather", help="Weather for the study of a honeybee model."),
    ] = None,
    materials: Annotated[
        Path | None,
        typer.Option(
            "--materials", help="Material map (.toml) of an OBJ or glTF file."
        ),
    ] = None,
    quiet: Quiet = False,
) -> None:
    """Turn a honeybee model into a study, or an OBJ or glTF file into a scene.

    A honeybee model gives scene, windows, BSDFs, sensors, views and, with weather, a
    study. What could not be taken over is told.
    """
    kind = model.suffix.lower()
    if kind in _HONEYBEE:
        read = read_hbjson(model)
        if weather is not None and not weather.is_file():
            raise InputError("is not there; a weather file expected", file=weather)
        _tell(write_honeybee_model(read, output, weather=weather), quiet)
        for left_out in () if quiet else read.unsupported:
            typer.echo(f"left out: {left_out}")
        return
    if kind not in _MESHES:
        known = ", ".join((*_HONEYBEE, *_MESHES))
        raise InputError(f'ending "{kind}"; one of {known} expected', file=model)
    given = MaterialMap({}) if materials is None else read_material_map(materials)
    scene = _mesh_scene(model, kind, given, colours=materials is None)
    _tell(write_scene(scene, output), quiet)


def _mesh_scene(model: Path, kind: str, given: MaterialMap, *, colours: bool) -> Scene:
    # Without a map, the file's own colours are matt plastics
    if kind == ".obj":
        if given.up == "y":
            raise InputError(
                '"up" is for glTF; an OBJ file with z up expected', file=model
            )
        return read_obj(
            model, materials=given.materials, colours=colours, scale=given.scale
        )
    return read_gltf(
        model,
        materials=given.materials,
        colours=colours,
        scale=given.scale,
        up=given.up or "y",
    )


def _tell(written: Written, quiet: bool) -> None:
    if quiet:
        return
    for file in written.files:
        typer.echo(f"wrote {file}")
    if written.study is not None:
        typer.echo(f"next: clerestory run {written.study}")
