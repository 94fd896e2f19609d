"""`clerestory bsdf package`: a BSDF file as something to put into a scene."""

import os
from pathlib import Path
from typing import Annotated

import typer

from clerestory.bsdf.xml_reader import read_bsdf
from clerestory.errors import InputError
from clerestory.files import write_text
from clerestory.radiance.bsdf_package import package
from clerestory.radiance.rad_writer import format_rad
from clerestory.scene.model import BsdfSurface
from clerestory.scene.transform import parse_transform


def package_file(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="BSDF file to read.")],
    output: Annotated[
        Path | None,
        typer.Option(
            "--output", "-o", help="Scene file; standard output if not given."
        ),
    ] = None,
    xform: Annotated[
        str,
        typer.Option("--xform", help='Where it goes, such as "-rx 90 -t 1 0 2".'),
    ] = "",
) -> None:
    """Make a scene file of a BSDF: surfaces that scatter by it, and its geometry.

    The layer stands around the origin, y up, its room side towards +z. Geometry that
    the file holds stands between a surface in front and one behind.
    """
    words = xform.split()
    transform, taken = parse_transform(words)
    if taken < len(words):
        raise InputError(f"--xform {words[taken]!r}; an option of xform expected")
    bsdf = read_bsdf(file)
    name = "".join(c if c.isalnum() or c in "._-" else "_" for c in file.stem)
    scene = package(bsdf, name, transform=transform)

    # The scene names the BSDF file as seen from its own folder
    folder = Path() if output is None else output.parent
    path = Path(os.path.relpath(file, folder)).as_posix()
    files = {k: path for k, m in scene.materials.items() if isinstance(m, BsdfSurface)}
    head = f"# {bsdf.product.name or name}, by clerestory bsdf package {file.name}\n\n"
    text = head.replace("\r", " ") + format_rad(scene, bsdf_file=files)
    if output is None:
        typer.echo(text, nl=False)
        return
    write_text(output, text)
    typer.echo(f"{output}: {len(scene.surfaces)} surfaces, {len(files)} with the BSDF")
