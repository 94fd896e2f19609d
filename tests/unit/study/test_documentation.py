"""The page about study files names every key and default, and shows a good study."""

import re
import tomllib
from pathlib import Path

import pytest
from pydantic import BaseModel

from clerestory.study.config import Study

PAGE = (Path(__file__).parents[3] / "docs" / "study-file.md").read_text("utf-8")


def keys():
    for table, field in Study.model_fields.items():
        annotation = field.annotation
        inner = getattr(annotation, "__args__", (annotation,))[0]
        if isinstance(inner, type) and issubclass(inner, BaseModel):
            for key, item in inner.model_fields.items():
                yield table, item.alias or key, item.default
        else:
            yield "", table, field.default


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
    assert set(example) <= set(Study.model_fields)
    assert example["method"] == "3-phase"
