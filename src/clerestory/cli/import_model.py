"""`clerestory import`: conversion of models of other programs to scenes and studies."""

from collections.abc import Callable
from functools import partial
from pathlib import Path

from clerestory.checks import one_of, require
from clerestory.cli.progress import say
from clerestory.cli.requests.study import ImportModel
from clerestory.errors import located
from clerestory.formats.building_model import BuildingModel
from clerestory.formats.gltf import read_gltf
from clerestory.formats.hbjson import read_hbjson
from clerestory.formats.ifc import read_ifc
from clerestory.formats.obj import read_obj
from clerestory.radiance.material_map import MaterialMap, read_material_map
from clerestory.scene.model import Scene
from clerestory.study.model_import import Written, write_building_model, write_scene

_HONEYBEE, _IFC = (".hbjson", ".json"), (".ifc",)
_MESHES = (".obj", ".gltf", ".glb")


def import_model(request: ImportModel) -> None:
    """Convert a model, and print the written files and the omitted objects."""
    model, weather, quiet = request.model, request.weather, request.quiet
    kind = model.suffix.lower()
    with located(file=model):
        one_of(kind, "extension", choices=(*_HONEYBEE, *_IFC, *_MESHES))
    if kind in _HONEYBEE + _IFC:
        read = _building(model, request.materials)
        require(
            weather is None or weather.is_file(),
            "does not exist; a weather file expected",
            file=weather,
        )
        with located(file=model):
            written = write_building_model(
                read,
                request.output,
                weather=weather,
                spacing=request.spacing,
                height=request.height,
                north_deg=request.north,
            )
        _tell(written, quiet)
        _tell_of_study(written, weather, quiet)
    else:
        _tell(write_scene(_mesh_scene(model, request.materials), request.output), quiet)


def _building(model: Path, materials: Path | None) -> BuildingModel:
    if model.suffix.lower() not in _IFC:
        return read_hbjson(model)
    given = MaterialMap({}) if materials is None else read_material_map(materials)
    plain = given.scale == 1 and given.up is None
    message = 'keys "scale" or "up"; IFC files have units and z up: no key expected'
    require(plain, message, file=materials)
    return read_ifc(model, materials=given.materials)


def _mesh_scene(model: Path, materials: Path | None) -> Scene:
    # Without a material map, the colours in the model file become diffuse plastics
    given = MaterialMap({}) if materials is None else read_material_map(materials)
    read: Callable[..., Scene] = partial(read_gltf, up=given.up or "y")
    if model.suffix.lower() == ".obj":
        require(
            given.up != "y",
            'key "up" is "y", but OBJ files have z up; no key expected',
            file=materials,
        )
        read = read_obj
    colours = materials is None
    return read(model, materials=given.materials, colours=colours, scale=given.scale)


def _tell_of_study(written: Written, weather: Path | None, quiet: bool) -> None:
    say(*(f"left out: {each}" for each in written.omitted), quiet=quiet)
    say(*(f"assumed: {each}" for each in written.assumed), quiet=quiet)
    if written.generated:
        count = len(written.generated)
        say(f"grids above the floors of rooms without sensors: {count}", quiet=quiet)
    if written.study is None:
        missing = "--weather FILE" if weather is None else "sensors or rooms"
        say(f"no study was written: {missing} expected", quiet=quiet)


def _tell(written: Written, quiet: bool) -> None:
    say(*(f"wrote {file}" for file in written.files), quiet=quiet)
    if written.study is not None:
        say(f"next: clerestory run {written.study}", quiet=quiet)
