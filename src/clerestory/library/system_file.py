"""Description of glazing systems in TOML.

    name = "Double glazing with an inner blind"

    [[layer]]
    file = "clear_3mm.dat"

    [[gap]]
    thickness_mm = 12.7
    gases = { argon = 0.9, air = 0.1 }

    [[layer]]
    file = "low_e.json"
    flipped = true

    [[gap]]
    thickness_mm = 50

    [[layer]]
    venetian = { material = "slat.json", width_mm = 25, spacing_mm = 20, tilt_deg = 45 }

Layers and gaps are listed from outdoors to indoors. File paths are relative to the
TOML file; `file` may also be the name of a built-in product, `library:NAME`.
"""

from pathlib import Path
from typing import Annotated

from pydantic import Field

from clerestory.checks import require
from clerestory.documents import Positive, read_toml
from clerestory.errors import located
from clerestory.glazing.glazing_system import (
    ATMOSPHERE,
    Gap,
    GlazingSystem,
    system_with_equal_gaps,
)
from clerestory.glazing.layer import Diffuser, Layer
from clerestory.glazing.layer_files import read_pane
from clerestory.glazing.shade_parameters import (
    GlazingTable,
    HoleParameters,
    SlatParameters,
    ThreadParameters,
)
from clerestory.library.bsdf_source import is_library_name
from clerestory.library.layer_source import read_layers

_MILLIMETRE = 1e-3


def read_system(path: str | Path) -> GlazingSystem:
    """Return the glazing system that a TOML file describes.

    Raises
    ------
    InputError : the file is not TOML, has wrong keys, or names an unreadable file
    """
    plan = read_toml(path, _Plan)
    folder = Path(path).parent
    layers: list[Layer] = []
    for number, row in enumerate(plan.layer, 1):
        with located(file=path, subject=f"layer {number}"):
            layers += _layers(row, folder)
    with located(file=path):
        name = plan.name or Path(path).stem
        if not plan.gap:
            return system_with_equal_gaps(layers, name=name)
        gaps = (
            Gap(row.thickness_mm * _MILLIMETRE, row.gases, row.pressure_pa)
            for row in plan.gap
        )
        return GlazingSystem(name, tuple(layers), tuple(gaps))


class _Row(GlazingTable):
    file: Path | None = None
    venetian: SlatParameters | None = None
    woven: ThreadParameters | None = None
    perforated: HoleParameters | None = None
    diffuser: Path | None = None
    flipped: bool = False


class _Space(GlazingTable):
    thickness_mm: Positive
    gases: dict[str, float] = Field(default_factory=lambda: {"air": 1.0})
    pressure_pa: Positive = ATMOSPHERE


class _Plan(GlazingTable):
    name: str = ""
    layer: Annotated[list[_Row], Field(min_length=1)]
    gap: tuple[_Space, ...] = ()


def _layers(row: _Row, folder: Path) -> list[Layer]:
    kinds = row.model_fields_set - {"flipped"}
    require(
        len(kinds) == 1,
        f"{' and '.join(sorted(kinds)) or 'nothing'} defined; one of file, venetian,"
        " woven, perforated or diffuser expected",
    )
    shade = row.venetian or row.woven or row.perforated
    if shade is not None:
        layers = [shade.layer(read_pane(folder / shade.material))]
    elif row.diffuser is not None:
        layers = [Diffuser(read_pane(folder / row.diffuser))]
    else:
        file = row.file or Path()
        layers = [*read_layers(file if is_library_name(file) else folder / file)]
    return [layer.flipped() for layer in reversed(layers)] if row.flipped else layers
