"""Honeybee models of our own, as JSON values of the public schema."""

GLASS = {
    "type": "Glass",
    "identifier": "pane",
    "r_transmissivity": 0.8,
    "g_transmissivity": 0.9,
    "b_transmissivity": 0.7,
    "refraction_index": None,
}
TINT = GLASS | {"identifier": "tint", "g_transmissivity": 0.1}


def face(name, points, kind="Wall", **more):
    return {
        "type": "Face",
        "identifier": name,
        "face_type": kind,
        "geometry": {"type": "Face3D", "boundary": points},
        "boundary_condition": {"type": "Outdoors"},
        "properties": {"radiance": {}},
    } | more


def box(name, low, high, **faces):
    """A room between two corners; `faces` are changes to its six faces, by side."""
    (x, y, z), (u, v, w) = low, high
    sides = {
        "floor": ([[x, y, z], [x, v, z], [u, v, z], [u, y, z]], "Floor"),
        "roof": ([[x, y, w], [u, y, w], [u, v, w], [x, v, w]], "RoofCeiling"),
        "south": ([[x, y, z], [u, y, z], [u, y, w], [x, y, w]], "Wall"),
        "north": ([[u, v, z], [x, v, z], [x, v, w], [u, v, w]], "Wall"),
        "west": ([[x, v, z], [x, y, z], [x, y, w], [x, v, w]], "Wall"),
        "east": ([[u, y, z], [u, v, z], [u, v, w], [u, y, w]], "Wall"),
    }
    return {
        "identifier": name,
        "faces": [
            face(f"{name}_{side}", points, kind, **faces.get(side, {}))
            for side, (points, kind) in sides.items()
        ],
        "properties": {},
    }


def aperture(name, points, **radiance):
    return {
        "type": "Aperture",
        "identifier": name,
        "geometry": {"boundary": points},
        "boundary_condition": {"type": "Outdoors"},
        "properties": {"radiance": radiance},
    }


def honeybee_model(*rooms, units="Meters", **radiance):
    properties = {"modifiers": [GLASS, TINT], "modifier_sets": []} | radiance
    return {
        "type": "Model",
        "identifier": "building",
        "units": units,
        "rooms": list(rooms),
        "properties": {"radiance": properties},
    }


def office(name="office", x=0.0, y=0.0, z=0.0, **faces):
    """A room of 4 m × 5 m × 3 m with a window of 2 m² to the south."""
    points = [[1, 0, 1], [3, 0, 1], [3, 0, 2], [1, 0, 2]]
    moved = [[a + x, b + y, c + z] for a, b, c in points]
    window = aperture(f"{name}_window", moved, modifier="pane")
    south = {"south": {"apertures": [window]}} | faces
    return box(name, (x, y, z), (x + 4, y + 5, z + 3), **south)


def building(rooms=100):
    """Offices on storeys of ten, whose east and west walls touch."""
    found = []
    for number in range(rooms):
        column, storey = number % 10, number // 10
        faces = {}
        for side, other, there in (("east", "west", 1), ("west", "east", -1)):
            twin = number + there
            if 0 <= column + there < 10 and 0 <= twin < rooms:
                objects = [f"r{twin}_{other}", f"r{twin}"]
                faces[side] = {
                    "boundary_condition": {
                        "type": "Surface",
                        "boundary_condition_objects": objects,
                    }
                }
        found.append(office(f"r{number}", x=4.0 * column, z=3.0 * storey, **faces))
    return honeybee_model(*found)
