"""`clerestory import`: conversion of models of other programs to scenes and studies."""

from pathlib import Path

import typer

from clerestory.cli.requests.study import ImportModel
from clerestory.errors import InputError
from clerestory.formats.gltf import read_gltf
from clerestory.formats.hbjson import read_hbjson
from clerestory.formats.obj import read_obj
from clerestory.radiance.material_map import MaterialMap, read_material_map
from clerestory.scene.model import Scene
from clerestory.study.model_import import Written, write_honeybee_model, write_scene

_HONEYBEE, _MESHES = (".hbjson", ".json"), (".obj", ".gltf", ".glb")


def import_model(request: ImportModel) -> None:
    """Convert a model, and print the written files and the omitted objects."""
    model, output, quiet = request.model, request.output, request.quiet
    weather, materials = request.weather, request.materials
    kind = model.suffix.lower()
    if kind in _HONEYBEE:
        read = read_hbjson(model)
        if weather is not None and not weather.is_file():
            raise InputError("no such file; a weather file expected", file=weather)
        _tell(write_honeybee_model(read, output, weather=weather), quiet)
        for left_out in () if quiet else read.unsupported:
            typer.echo(f"left out: {left_out}")
        return
    if kind not in _MESHES:
        known = ", ".join((*_HONEYBEE, *_MESHES))
        raise InputError(f'extension "{kind}"; one of {known} expected', file=model)
    given = MaterialMap({}) if materials is None else read_material_map(materials)
    scene = _mesh_scene(model, kind, given, colours=materials is None)
    _tell(write_scene(scene, output), quiet)


def _mesh_scene(model: Path, kind: str, given: MaterialMap, *, colours: bool) -> Scene:
    # Without a material map, the colours of the file become diffuse plastics
    if kind == ".obj":
        if given.up == "y":
            raise InputError(
                'key "up" applies only to glTF; OBJ files have z up', file=model
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
