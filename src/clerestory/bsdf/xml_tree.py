"""Reader of tensor trees in BSDF files."""

from typing import Literal

from lxml import etree

from clerestory.bsdf.tensor_tree import ScatteringTree
from clerestory.bsdf.tree_parser import parse_tree
from clerestory.bsdf.xml_document import Document

# Largest share of the flux in negative values.
_NEGLIGIBLE_NEGATIVE = 1e-3

_BASIS = "LBNL/Shirley-Chiu"


def tree_rank(kind: str) -> Literal[3, 4] | None:
    """Rank of an IncidentDataStructure; None if it is no tree.

    >>> tree_rank("TensorTree4"), tree_rank("Columns")
    (4, None)
    """
    ranks: dict[str, Literal[3, 4]] = {"tensortree3": 3, "tensortree4": 4}
    return ranks.get(kind.lower())


def read_tree(
    block: etree._Element, rank: Literal[3, 4], document: Document, notes: list[str]
) -> ScatteringTree:
    """Return the tree of a WavelengthDataBlock; irregularities are added to notes."""
    data = document.require(block, "ScatteringData")
    basis = document.text(block, "AngleBasis")
    if basis.lower() != _BASIS.lower():
        raise document.error(
            block, f"angle basis {basis[:60]!r} of a tensor tree; {_BASIS!r} expected"
        )
    number = document.trees.find(data.text)
    if len(data):
        raise document.error(
            data, "an element or a comment in a tensor tree; numbers alone expected"
        )
    if number is None:
        found = " ".join((data.text or "").split())[:40]
        raise document.error(
            data, f"no tensor tree but {found!r}; numbers in braces {{…}} expected"
        )
    line = document.lines_before + document.trees.first_line[number]
    text = document.trees.texts[number]
    table = parse_tree(text, rank=rank, file=document.path, line=line)

    # Half of a rank 3 tree is unused
    lost = 3.1416 * table.negative * (2 if rank == 3 else 1)
    if lost > _NEGLIGIBLE_NEGATIVE:
        raise document.error(
            data,
            f"negative values take away {lost:.2%} of the light; a BSDF without"
            " negative values expected",
        )
    if lost > 0:
        notes.append(
            f"line {line}: negative values, {lost:.1e} of the light, are read as zero"
        )
    return ScatteringTree(table.slots, rank, table.depth)
