"""Materials of a study by which its matrices are differentiated."""

from clerestory.checks import require
from clerestory.errors import InputError
from clerestory.matrix.derivatives import Parameter
from clerestory.scene.material_parameters import material_parameters
from clerestory.scene.model import Scene
from clerestory.study.config import Study


def study_parameters(study: Study, scene: Scene) -> tuple[Parameter, ...]:
    """Return the parameters by which the matrices of a study are differentiated.

    Raises
    ------
    InputError : no such material in the scene, or one without derivative
    """
    table = study.sensitivity
    if table is None:
        return ()
    try:
        found = material_parameters(scene, table.materials)
    except InputError as error:
        raise InputError(f"[sensitivity] materials: {error.message}") from error
    require(found, "[sensitivity]: no material reflects light; at least one expected")
    return found


def differentiated(study: Study, scene: Scene, traced: Scene) -> tuple[str, ...]:
    """Return the names of these materials that scatter light in a traced scene.

    In a scene of direct light, opaque materials are black.
    """
    known = {each.name for each in material_parameters(traced, "all")}
    names = [each.name for each in study_parameters(study, scene)]
    return tuple(name for name in names if name in known)


def check_parameters(study: Study, scene: Scene, *, stored: bool) -> None:
    """Require materials whose derivatives are known in all terms of the method."""
    parameters = study_parameters(study, scene)
    require(
        not (parameters and stored),
        "[sensitivity] with view matrices that do not fit into memory_gb; fewer sensors"
        " or a larger memory_gb expected",
    )
    for each in parameters if study.corrected else ():
        require(
            scene.materials[each.name].opaque,
            f'[sensitivity] material "{each.name}" transmits light, and the derivative'
            " of the direct sun is not computed; opaque materials, or a method without"
            " exact sun, expected",
        )
