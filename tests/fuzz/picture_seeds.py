"""Pictures and photographs."""

import importlib
import warnings
from collections.abc import Callable
from pathlib import Path

import numpy as np
from reader import Reader

import clerestory as cl
from clerestory.errors import InputError


def _picture() -> object:
    picture = importlib.import_module("clerestory.image.picture")
    view = importlib.import_module("clerestory.scene.view")
    values = np.random.default_rng(0).uniform(0, 20, (20, 20, 3)).astype(np.float32)
    return picture.Picture(
        values, view=view.View(kind="angular", horizontal=180, vertical=180)
    )


def _hdr(folder: Path) -> list[bytes]:
    cl.write_picture(_picture(), folder / "seed.hdr")
    data = (folder / "seed.hdr").read_bytes()
    head = data[: data.index(b"-Y 20")] + b"-Y 20 +X 20\n"
    rng = np.random.default_rng(1)
    flat = rng.integers(1, 255, (400, 4), dtype=np.uint8)
    flat[:, 3] = rng.integers(120, 140, 400)
    return [data, head + flat.tobytes(), data.replace(b"rle_rgbe", b"rle_xyze")]


def _exr(folder: Path) -> list[bytes]:
    cl.write_picture(_picture(), folder / "seed.exr")
    return [(folder / "seed.exr").read_bytes()]


def _jpeg(folder: Path) -> list[bytes]:
    image = importlib.import_module("PIL.Image").new("RGB", (16, 16), (90, 80, 70))
    exif = image.getexif()
    exif.get_ifd(0x8769).update({0x829A: 0.01, 0x829D: 4.0, 0x8827: 100})
    image.save(folder / "seed.jpg", exif=exif)
    image.save(folder / "seed.png")
    return [(folder / "seed.jpg").read_bytes(), (folder / "seed.png").read_bytes()]


# Pixels of the largest pictures that are evaluated for glare
_LARGEST = 10_000


def _judged(function: Callable[..., cl.Picture], path: Path) -> object:
    # Pixels are finite, and indices of glare are in their ranges
    picture = function(path)
    assert np.all(np.isfinite(picture.radiance)), "a pixel that is not finite"
    if picture.rows * picture.columns > _LARGEST:
        return picture
    evaluate = importlib.import_module("clerestory.glare.evaluate").evaluate_glare
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            found = evaluate(picture, trust=True)
        except InputError:
            return picture
    assert 0 <= found.dgp <= 1, f"a DGP of {found.dgp}"
    assert np.isfinite(found.illuminance), "an illuminance that is not finite"
    return picture


def _flat(folder: Path) -> list[bytes]:
    first = _hdr(folder)[0]
    (folder / "V_000.hdr").write_bytes(first)
    return [first]


def _set(function: Callable[..., object], path: Path) -> object:
    return function(path.with_name("V_%03d.hdr"))


def _shown(function: Callable[..., str], path: Path) -> object:
    # Damaged notes are shown too
    shown = importlib.import_module("clerestory.report.markdown").markdown
    return shown(function(path))


LEVELS = "value,red,green,blue\n" + "".join(
    f"{value}" + 3 * f",{value / 255:.6f}" + "\n" for value in range(256)
)
READERS = {
    "hdr": Reader("image.picture_files:read_picture", "p.hdr", make=_hdr, use=_judged),
    "exr": Reader("image.picture_files:read_picture", "p.exr", make=_exr, use=_judged),
    "report picture": Reader(
        "report.view_pictures:read_small",
        "p.hdr",
        make=lambda folder: _hdr(folder)[:1],
        use=lambda function, path: function(path, width=10),
    ),
    "picture set": Reader(
        "image.picture_sets:read_picture_set", "V_001.hdr", make=_flat, use=_set
    ),
    "photograph": Reader("image.photograph:read_photograph", "p.jpg", make=_jpeg),
    "logo": Reader("study.title_block:read_logo", "l.png", make=_jpeg),
    "notes": Reader(
        "study.title_block:read_notes",
        "n.md",
        ("# Notes\n\n| a | b |\n|---|---|\n| 1 | [x](y) |\n\n- *one*\n\n> `two`\n",),
        use=_shown,
    ),
    "exposure": Reader(
        "image.photograph:read_exposure", "p.jpg", make=lambda f: _jpeg(f)[:1]
    ),
    "response": Reader(
        "image.camera_response:read_response",
        "r.rsp",
        ("2 .5 .5 0\n" * 3, LEVELS),
    ),
}
