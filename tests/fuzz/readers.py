"""All readers of files from outside, by name."""

import optics_seeds
import picture_seeds
import recipe_seeds
import result_seeds
import scene_seeds
import weather_seeds

READERS = {
    **scene_seeds.READERS,
    **optics_seeds.READERS,
    **weather_seeds.READERS,
    **picture_seeds.READERS,
    **result_seeds.READERS,
    **recipe_seeds.READERS,
}
