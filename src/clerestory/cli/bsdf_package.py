"""`clerestory bsdf package`: a BSDF file as surfaces of a scene."""

import os
from pathlib import Path

import typer

from clerestory.cli.requests.bsdf import PackageBsdf
from clerestory.errors import InputError
from clerestory.escaping import header_line
from clerestory.files import write_text
from clerestory.library.bsdf_source import read_bsdf
from clerestory.radiance.bsdf_package import package as package_bsdf
from clerestory.radiance.rad_writer import format_rad
from clerestory.scene.model import BsdfSurface
from clerestory.scene.transform import parse_transform


def package(request: PackageBsdf) -> None:
    """Write a Radiance scene file with the surfaces of a BSDF."""
    file, output = request.file, request.output
    words = request.xform.split()
    transform, taken = parse_transform(words)
    if taken < len(words):
        raise InputError(
            f"--xform contains {words[taken]!r}; options of xform expected"
        )
    bsdf = read_bsdf(file)
    name = file.stem.replace(" ", "_")
    scene = package_bsdf(bsdf, name, transform=transform)

    # Path of the BSDF file relative to the folder of the scene
    folder = Path() if output is None else output.parent
    path = Path(os.path.relpath(file, folder)).as_posix()
    files = {k: path for k, m in scene.materials.items() if isinstance(m, BsdfSurface)}
    made = f"by clerestory bsdf package {file.name}"
    head = header_line(f"{bsdf.product.name[:200] or name}, {made}")
    text = f"# {head}\n\n{format_rad(scene, bsdf_file=files)}"
    if output is None:
        typer.echo(text, nl=False)
        return
    write_text(output, text)
    typer.echo(f"{output}: {len(scene.surfaces)} surfaces, {len(files)} with the BSDF")
