"""Function files of Radiance whose functions are written in Python here."""

from collections.abc import Mapping

from clerestory.scene.cal.library import Native
from clerestory.scene.cal.luminaires import SOURCE
from clerestory.scene.cal.skies import PEREZLUM, SKYBRIGHT

NATIVE_FILES: Mapping[str, Mapping[str, Native]] = {
    "skybright.cal": SKYBRIGHT,
    "perezlum.cal": PEREZLUM,
    "source.cal": SOURCE,
}
