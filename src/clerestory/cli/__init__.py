"""Command line of the package: one module for each command or group of commands."""
