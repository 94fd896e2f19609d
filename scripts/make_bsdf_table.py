"""Table of docs/bsdf.md: what is in each BSDF file of a folder, or why it is refused.

Run as `python scripts/make_bsdf_table.py FOLDER`; the table goes to standard output.
"""

import sys
import warnings
from pathlib import Path

from clerestory.bsdf.bsdf import Bsdf
from clerestory.bsdf.tensor_tree import ScatteringTree
from clerestory.bsdf.xml_reader import read_bsdf
from clerestory.errors import InputError


def describe(bsdf: Bsdf) -> str:
    """Kind and size of the functions of a BSDF, and its channels."""
    part = next(iter(bsdf.functions.values()))
    if isinstance(part, ScatteringTree):
        depth = max(
            one.depth for one in bsdf.functions.values() if isinstance(one, type(part))
        )
        kind = f"tree of rank {part.rank}, 2^{depth} cells along an axis"
    else:
        exits, incidents = part.own_partitions() or ((), ())
        kind = f"matrix {len(exits)} × {len(incidents)}"
    return f"{kind}; {len(bsdf.functions)} functions; {', '.join(bsdf.channels)}"


def row(file: Path, folder: Path) -> str:
    """One row of the table."""
    name = file.relative_to(folder)
    try:
        return f"| {name} | {describe(read_bsdf(file))} |"
    except InputError as error:
        return f"| {name} | refused, line {error.line}: {error.message} |"


def main() -> None:
    """Print the table."""
    folder = Path(sys.argv[1])
    warnings.simplefilter("ignore")
    sys.stdout.write("| file | contents |\n| --- | --- |\n")
    files = (file for file in folder.rglob("*") if file.suffix.lower() == ".xml")
    for file in sorted(files):
        sys.stdout.write(row(file, folder) + "\n")


if __name__ == "__main__":
    main()
