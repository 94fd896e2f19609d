"""How long scene files of a given size take to load: Radiance text and Wavefront OBJ.

    python benchmarks/load.py [--megabytes 200] [--folder DIR] [--write FILE]

The files hold balls: one as polygons of a `.rad`, one as vertices and faces of an
`.obj`. Each is read in a process of its own that does nothing else.
"""

import argparse
import json
import os
import subprocess
import sys
import tempfile
from datetime import UTC, datetime
from pathlib import Path

import numpy as np
from hall import space_frame, write_obj

import clerestory as cl
from clerestory.scene.model import TriangleMesh

# Reads a file and tells what that took
_READER = """
import json, resource, sys, time
import numpy as np
import clerestory as cl
from clerestory.scene.model import Plastic
wall, cpu = time.perf_counter(), time.process_time()
file = sys.argv[1]
grey = Plastic("grey", np.full(3, 0.5))
if file.endswith(".obj"):
    scene = cl.read_obj(file, materials={"*": grey})
else:
    scene = cl.read_rad(file)
print(json.dumps({
    "wall": time.perf_counter() - wall,
    "cpu": time.process_time() - cpu,
    "peak_gb": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6,
    "surfaces": len(scene.surfaces),
}))
"""

# About what a triangle takes in each kind of file [bytes]
_BYTES = {"rad": 106, "obj": 36.5}


def write_rad(mesh: TriangleMesh, path: Path) -> None:
    """Write the triangles of a mesh as polygons of a Radiance scene."""
    corners = mesh.vertices[mesh.faces].reshape(-1, 9)
    form = "\ngrey polygon p.%d\n0\n0\n9" + 3 * "\n\t%.6g %.6g %.6g" + "\n"
    with path.open("w") as file:
        file.write("void plastic grey\n0\n0\n5 0.5 0.5 0.5 0 0\n")
        for number, row in enumerate(corners.tolist()):
            file.write(form % (number, *row))


def measured(path: Path) -> dict[str, float]:
    """Return what reading a file takes, in a process of its own."""
    done = subprocess.run(
        [sys.executable, "-c", _READER, str(path)],
        check=True,
        capture_output=True,
        text=True,
    )
    return dict(json.loads(done.stdout))


def main() -> None:
    """Write both files, read them, and print or write what it took."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--megabytes", type=float, default=200)
    parser.add_argument("--folder", type=Path, default=Path(tempfile.gettempdir()))
    parser.add_argument("--write", type=Path, help="a page")
    options = parser.parse_args()
    lines = [
        f"### Loading scene files of {options.megabytes:.0f} MB",
        "",
        f"{datetime.now(tz=UTC).date()}, {os.cpu_count()} cores, clerestory"
        f" {cl.__version__}, load {os.getloadavg()[0]:.1f} before.",
        "",
        "| file | MB | triangles | seconds | processor seconds | most memory [GB] |",
        "|---|---|---|---|---|---|",
    ]
    with tempfile.TemporaryDirectory(dir=options.folder) as folder:
        for kind, write in (("rad", write_rad), ("obj", write_obj)):
            mesh = space_frame(int(options.megabytes * 1e6 / _BYTES[kind]))
            path = Path(folder, f"hall.{kind}")
            write(mesh, path)
            size, count = path.stat().st_size / 1e6, len(mesh.faces)
            del mesh
            took = measured(path)
            lines.append(
                f"| .{kind} | {size:.0f} | {np.round(count, -3):,} | {took['wall']:.1f}"
                f" | {took['cpu']:.1f} | {took['peak_gb']:.1f} |"
            )
            print(lines[-1], flush=True)
    text = "\n".join(lines) + "\n"
    print(text)
    if options.write:
        options.write.write_text(text)


if __name__ == "__main__":
    main()
