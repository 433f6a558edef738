"""What all tests share: tables put back after each test."""
import pytest

from addon.brdf import tables


@pytest.fixture
def table_folder(tmp_path):
    """An empty folder that tables are read from and baked to during one test."""
    tables.use_folder(tmp_path)
    yield tmp_path
    tables.use_folder()
