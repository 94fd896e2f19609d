"""Distributed tracing on a dask.distributed cluster."""
