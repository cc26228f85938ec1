"""A clean copy of the workflow for the tests of studies."""

import pytest
from clone import copy_of_the_project


@pytest.fixture
def project(tmp_path):
    """What a clone holds of the workflow."""
    return copy_of_the_project(tmp_path)
