"""Field of study files for a BSDF: a file, or the name of a built-in product."""

from pathlib import Path
from typing import Annotated

from clerestory.library.bsdf_source import library_layers
from clerestory.study.file_fields import file_or_name

BSDF = "a BSDF file (.xml), or library:NAME"

BsdfFile = Annotated[Path, file_or_name(library_layers)]
