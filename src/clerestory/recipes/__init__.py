"""Recipes: simulations with the inputs and result folders of Ladybug Tools."""
