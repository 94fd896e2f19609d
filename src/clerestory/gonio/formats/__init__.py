"""Readers of goniophotometer files, one format a file."""
