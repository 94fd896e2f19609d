"""The page about study files names every key and default, and shows a good study."""

import re
import tomllib
from pathlib import Path

import pytest
from pydantic import BaseModel

from clerestory.sky.station_file import MeasuredTable
from clerestory.study.config import Study

PAGE = (Path(__file__).parents[3] / "docs" / "study-file.md").read_text("utf-8")


def table_of(annotation):
    for part in (annotation, *getattr(annotation, "__args__", ())):
        if isinstance(part, type) and issubclass(part, BaseModel):
            return part
    return None


def keys(model=Study, path=""):
    for key, field in model.model_fields.items():
        inner, name = table_of(field.annotation), field.alias or key
        inner = None if inner is MeasuredTable else inner
        if inner is not None:
            yield from keys(inner, f"{path}.{name}" if path else name)
        if inner is None or path:
            yield path, name, field.default


@pytest.mark.parametrize(("table", "key", "default"), list(keys()))
def test_every_key_is_on_the_page_with_its_default(table, key, default):
    sections = re.split(r"^#+ ", PAGE, flags=re.MULTILINE)
    heading = f"[{table}]" if table else "Keys"
    section = next(part for part in sections if heading in part.split("\n")[0])
    row = next(line for line in section.split("\n") if f"`{key}`" in line)
    if isinstance(default, bool):
        assert str(default).lower() in row
    elif isinstance(default, int | float):
        assert f"{default:g}" in row


def test_the_example_names_known_keys_only():
    example = tomllib.loads(re.search(r"```toml\n(.*?)```", PAGE, re.DOTALL)[1])
    assert set(example) <= {f.alias or key for key, f in Study.model_fields.items()}
    assert example["method"] == "3-phase"
