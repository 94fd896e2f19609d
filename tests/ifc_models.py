"""IFC files of a small room, as text, with dimensions that are known.

The floor is 4 m × 5 m without a corner of 1 m × 1 m, 19 m²; the room is 3 m high. In
the wall at y = 0 is a window of 2 m × 1.5 m with a frame of 0.1 m: 1.8 m × 1.3 m of
glass, 2.34 m².
"""

from collections.abc import Sequence

FLOOR, GLASS, OPENING = 19.0, 1.8 * 1.3, 2.0 * 1.5

# Outline of the floor of the room [m]
ROOM = [(0, 0), (4, 0), (4, 4), (3, 4), (3, 5), (0, 5)]


class _Step:
    # Lines of a STEP file; lengths are in units of `metres`
    def __init__(self, metres: float) -> None:
        self.lines: list[str] = []
        self.metres = metres
        self.count = 0

    def add(self, kind: str, *values: str) -> str:
        self.lines.append(f"#{len(self.lines) + 1}={kind}({','.join(values)});")
        return f"#{len(self.lines)}"

    def root(self, kind: str, name: str, *values: str) -> str:
        self.count += 1
        guid = f"'{self.count:022d}'"
        return self.add(kind, guid, "$", f"'{name}'", "$", *values)

    def length(self, value: float) -> str:
        return f"{value / self.metres:.9g}".replace("e", "E") + (
            "" if "." in f"{value / self.metres:.9g}" else "."
        )

    def point(self, *values: float) -> str:
        return self.add("IFCCARTESIANPOINT", _list(map(self.length, values)))

    def direction(self, *values: float) -> str:
        return self.add("IFCDIRECTION", _list(f"{float(v)!r}" for v in values))

    def placed(self, *values: float) -> str:
        axes = self.add("IFCAXIS2PLACEMENT3D", self.point(*values), "$", "$")
        return self.add("IFCLOCALPLACEMENT", "$", axes)

    def prism(self, outline: Sequence[tuple[float, float]], low: float, high: float):
        """Extrude an outline of the plan between two heights."""
        corners = [self.point(*xy) for xy in (*outline, outline[0])]
        curve = self.add("IFCPOLYLINE", _list(corners))
        profile = self.add("IFCARBITRARYCLOSEDPROFILEDEF", ".AREA.", "$", curve)
        axes = self.add("IFCAXIS2PLACEMENT3D", self.point(0, 0, low), "$", "$")
        up = self.direction(0, 0, 1)
        depth = self.length(high - low)
        return self.add("IFCEXTRUDEDAREASOLID", profile, axes, up, depth)

    def faces(self, x: float, y: float, z: float, reversed_: Sequence[int]) -> str:
        """Floor, ceiling and walls of a box as faces, some of them reversed."""
        low, high = ([(0, 0, h), (x, 0, h), (x, y, h), (0, y, h)] for h in (0, z))
        rings = [low[::-1], high]
        for k in range(4):
            n = (k + 1) % 4
            rings.append([low[k], low[n], high[n], high[k]])
        made = []
        for number, ring in enumerate(rings):
            ends = ring[::-1] if number in reversed_ else ring
            loop = self.add("IFCPOLYLOOP", _list(self.point(*end) for end in ends))
            bound = self.add("IFCFACEOUTERBOUND", loop, ".T.")
            made.append(self.add("IFCFACE", _list([bound])))
        whole = self.add("IFCCONNECTEDFACESET", _list(made))
        return self.add("IFCFACEBASEDSURFACEMODEL", _list([whole]))

    def box(self, low: Sequence[float], high: Sequence[float]) -> str:
        (x, y, z), (u, v, w) = low, high
        return self.prism([(x, y), (u, y), (u, v), (x, v)], z, w)


def _list(values) -> str:
    return f"({','.join(values)})"


def ifc_room(
    *,
    metres: float = 0.001,
    north: tuple[float, float] | None = (0.5, 0.75**0.5),
    window: str = "style",
    shift: float = 0.0,
    numbers: dict[str, float] | None = None,
    extra: Sequence[str] = (),
    space_faces: Sequence[int] | None = None,
) -> str:
    """Return the text of an IFC4 file.

    `window`: "style", glass by its surface style; "shape", a frame and a pane without
    style; "box", one box; "opening", an opening in the wall only. `numbers`: properties
    of the window. `shift`: translation of the building along x [m]. `space_faces`: the
    space is a box of six faces, 4 m × 5 m × 3 m, of which these are reversed.
    """
    step = _Step(metres)
    prefix = {1.0: "$", 0.001: ".MILLI."}[metres]
    unit = step.add("IFCSIUNIT", "*", ".LENGTHUNIT.", prefix, ".METRE.")
    units = step.add("IFCUNITASSIGNMENT", _list([unit]))
    axes = step.add("IFCAXIS2PLACEMENT3D", step.point(0, 0, 0), "$", "$")
    context = step.add(
        "IFCGEOMETRICREPRESENTATIONCONTEXT",
        *("$", "'Model'", "3", "1.E-05", axes),
        "$" if north is None else step.direction(*north),
    )
    held = ("$", "'Test house'", "$", _list([context]), units)
    project = step.root("IFCPROJECT", "P", *held)
    place = step.placed(shift, 0, 0)
    site = step.root(
        "IFCSITE",
        "site",
        *("$", place, "$", "$", ".ELEMENT.", "(59,54,30)", "(-10,-45,0)", "0."),
        *("$", "$"),
    )
    step.root("IFCRELAGGREGATES", "a", project, _list([site]))

    def shaped(*solids: str) -> str:
        shape = (context, "'Body'", "'SweptSolid'", _list(solids))
        body = step.add("IFCSHAPEREPRESENTATION", *shape)
        return step.add("IFCPRODUCTDEFINITIONSHAPE", "$", "$", _list([body]))

    # Space, slabs and walls
    prism = space_faces is None
    body = shaped(step.prism(ROOM, 0, 3) if prism else step.faces(4, 5, 3, space_faces))
    space = ("$", place, body, "'Office'", ".ELEMENT.", ".INTERNAL.", "$")
    spaces = [step.root("IFCSPACE", "1.01", *space)]
    for name, low, high, kind in (
        ("floor", -0.3, 0.0, ".FLOOR."),
        ("roof", 3.0, 3.3, ".ROOF."),
    ):
        slab = step.box((-0.2, -0.2, low), (4.2, 5.2, high))
        step.root("IFCSLAB", name, "$", place, shaped(slab), "$", kind)
    walls = [
        step.root("IFCWALL", name, "$", place, shaped(step.box(low, high)), "$", "$")
        for name, low, high in (
            ("south", (-0.2, -0.2, 0), (4.2, 0, 3)),
            ("north", (-0.2, 5, 0), (3, 5.2, 3)),
            ("east", (4, 0, 0), (4.2, 4, 3)),
            ("west", (-0.2, 0, 0), (0, 5, 3)),
            ("corner", (3, 4, 0), (4.2, 5.2, 3)),
        )
    ]
    desk = shaped(step.box((2, 2, 0.7), (3, 2.5, 0.74)))
    step.root("IFCFURNITURE", "desk", "$", place, desk, "$", "$")

    # Window in an opening of the south wall
    hole = shaped(step.box((1, -0.3, 0.9), (3, 0.1, 2.4)))
    opening = step.root("IFCOPENINGELEMENT", "hole", "$", place, hole, "$", ".OPENING.")
    step.root("IFCRELVOIDSELEMENT", "v", walls[0], opening)
    frame = [
        step.box((1, -0.15, 0.9), (3, -0.05, 1.0)),
        step.box((1, -0.15, 2.3), (3, -0.05, 2.4)),
        step.box((1, -0.15, 1.0), (1.1, -0.05, 2.3)),
        step.box((2.9, -0.15, 1.0), (3, -0.05, 2.3)),
    ]
    panes = [step.box((1.1, y, 1.0), (2.9, y + 0.006, 2.3)) for y in (-0.12, -0.09)]
    if window == "style":
        for pane in panes:
            _glass(step, pane)
    solids = {"box": [step.box((1, -0.15, 0.9), (3, -0.05, 2.4))], "opening": []}
    parts = solids.get(window, [*frame, *panes])
    shape = shaped(*parts) if parts else "$"
    size = (step.length(1.5), step.length(2.0))
    given = ("$", place, shape, "$", *size, ".WINDOW.", "$", "$")
    filling = step.root("IFCWINDOW", "W1", *given)
    step.root("IFCRELFILLSELEMENT", "f", opening, filling)
    if numbers:
        values = [
            step.add("IFCPROPERTYSINGLEVALUE", f"'{name}'", "$", f"IFCREAL({v})", "$")
            for name, v in numbers.items()
        ]
        pset = step.root("IFCPROPERTYSET", "Pset_Glazing", _list(values))
        step.root("IFCRELDEFINESBYPROPERTIES", "d", _list([filling]), pset)
    step.root("IFCRELAGGREGATES", "s", site, _list(spaces))
    lines = "\n".join([*step.lines, *extra])
    return (
        "ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION((''),'2;1');\n"
        "FILE_NAME('','',(''),(''),'','','');\nFILE_SCHEMA(('IFC4'));\nENDSEC;\n"
        f"DATA;\n{lines}\nENDSEC;\nEND-ISO-10303-21;\n"
    )


def _glass(step: _Step, solid: str) -> None:
    # A surface style that is transparent, without a name
    colour = step.add("IFCCOLOURRGB", "$", "0.8", "0.9", "0.9")
    shading = step.add("IFCSURFACESTYLESHADING", colour, "0.8")
    style = step.add("IFCSURFACESTYLE", "$", ".BOTH.", _list([shading]))
    step.add("IFCSTYLEDITEM", solid, _list([style]), "$")
