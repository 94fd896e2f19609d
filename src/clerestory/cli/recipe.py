"""`clerestory recipe`: recipes of Ladybug Tools, with their inputs and outputs."""

from clerestory.cli.progress import progress_display, say
from clerestory.cli.requests.study import RunRecipe
from clerestory.engine.device import limit_threads
from clerestory.recipes.recipe import run_recipe


def recipe(request: RunRecipe) -> None:
    """Run a recipe and print the paths of its outputs."""
    limit_threads(request.workers)
    with progress_display(quiet=request.quiet) as display:
        found = run_recipe(
            request.name, request.inputs, folder=request.folder, display=display
        )
    say(*(f"{name}: {path}" for name, path in found.items()), quiet=request.quiet)
