"""Every compute device present, for tests that trace."""

import pytest

from clerestory.engine import device as devices
from clerestory.errors import DeviceError


@pytest.fixture(params=["cpu", pytest.param("cuda", marks=pytest.mark.cuda)])
def device(request):
    """Name of a compute device; the test skips where it is missing."""
    try:
        devices.load(request.param)
    except DeviceError as error:
        pytest.skip(str(error))
    return request.param
