"""Recipes of Ladybug Tools: simulations with their inputs and result folders."""

from pathlib import Path

from clerestory.checks import one_of
from clerestory.progress import silent
from clerestory.recipes.inputs import read_inputs, traced_effort
from clerestory.recipes.interfaces import RECIPES
from clerestory.recipes.model import read_model, read_model_views
from clerestory.recipes.visualization import VISUALIZATION, write_visualization
from clerestory.study.job import Display


def run_recipe(
    name: str,
    inputs: str | Path,
    *,
    folder: str | Path,
    display: Display | None = None,
) -> dict[str, Path]:
    """Run a recipe, and return the paths of its outputs by name.

    Parameters
    ----------
    name : name of the recipe, such as "annual-daylight"
    inputs : JSON file with the inputs of the recipe
    folder : project folder; the results are in a folder with the name of the recipe,
        words separated by underscores
    display : function that starts the progress display of a phase, given its name

    Raises
    ------
    InputError : the recipe or an input is unknown, or an input is invalid
    """
    one_of(name, "recipe", choices=RECIPES)
    recipe = RECIPES[name]
    values = read_inputs(inputs, recipe.inputs)
    if "radiance-parameters" in values:
        traced_effort(values["radiance-parameters"])
    if "view-filter" in values:
        chosen = read_model_views(values["model"], view_filter=values["view-filter"])
    else:
        chosen = read_model(
            values["model"],
            grid_filter=values["grid-filter"],
            window_groups=recipe.window_groups,
        )
    place = Path(folder) / name.replace("-", "_")
    recipe.run(chosen, values, place, display or silent)
    found = {key: place / path for key, path in recipe.outputs.items()}
    if recipe.shown:
        write_visualization(place, chosen, recipe.shown)
        found["visualization"] = place / VISUALIZATION
    return found
