"""Materials of a study by which its matrices are differentiated."""

from clerestory.checks import require
from clerestory.errors import InputError
from clerestory.phases.methods import METHODS
from clerestory.scene.material_parameters import material_parameters
from clerestory.scene.model import Scene
from clerestory.study.config import Study


def checked_materials(study: Study, scene: Scene, *, stored: bool) -> tuple[str, ...]:
    """Return the names of the materials of [sensitivity]; none without this table.

    `stored` tells whether view matrices are too large for memory.

    Raises
    ------
    InputError : no such material in the scene, or derivatives that are not computed
    """
    table = study.sensitivity
    if table is None:
        return ()
    try:
        found = material_parameters(scene, table.materials)
    except InputError as error:
        raise InputError(f"[sensitivity] materials: {error.message}") from error
    require(found, "[sensitivity]: no material reflects light; at least one expected")
    require(
        not (table.glare and METHODS[study.method].facade),
        f'[sensitivity] glare with method "{study.method}"; a method without ports'
        " expected",
    )
    require(
        not stored,
        "[sensitivity] with view matrices that do not fit into memory_gb; fewer sensors"
        " or a larger memory_gb expected",
    )
    for each in found if study.corrected else ():
        require(
            scene.materials[each.name].opaque,
            f'[sensitivity] material "{each.name}" transmits light, and the derivative'
            " of the direct sun is not computed; opaque materials, or a method without"
            " exact sun, expected",
        )
    return tuple(each.name for each in found)
