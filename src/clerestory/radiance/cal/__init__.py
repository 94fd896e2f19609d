"""Radiance's function language (calcomp), over arrays, with every run bounded."""
