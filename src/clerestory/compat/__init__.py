"""Programs of Radiance that scripts call, on the engine of this package."""
