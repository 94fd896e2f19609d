"""The page on scenes says of every type of Radiance whether it is read."""

import re
from pathlib import Path

from clerestory.radiance.instance import INSTANCE_KINDS
from clerestory.radiance.pattern_reader import PATTERN_KINDS
from clerestory.radiance.primitives import SURFACES
from clerestory.radiance.statements import MODIFIER_KINDS, SURFACE_KINDS
from clerestory.scene.materials import READERS as MATERIALS

PAGE = Path(__file__).parents[3] / "docs" / "scene.md"
ROW = re.compile(r"^\| `(\w+)` \| (yes|no) \|", re.MULTILINE)


def test_the_page_lists_what_is_read_and_what_is_not():
    said = dict(ROW.findall(PAGE.read_text("utf-8")))
    read = {*MATERIALS, *PATTERN_KINDS, *SURFACES, *INSTANCE_KINDS, "polygon", "alias"}
    assert {kind for kind, word in said.items() if word == "yes"} == read
    assert said.keys() == MODIFIER_KINDS | SURFACE_KINDS | {"alias"}
