"""Evaluation of Radiance's function language (calcomp) for arrays of rays."""
