"""Readers of goniophotometer files, one module per file format."""
