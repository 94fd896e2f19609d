"""Luminaires: intensity tables from files, and the surfaces that send such light."""
