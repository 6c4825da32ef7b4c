"""Options shared by the whole suite: `--slow`, and hypothesis without a clock."""

from __future__ import annotations

import pytest
from hypothesis import settings

# deadline: the suite shares two cores, so a slow example says nothing about the code;
# derandomize: a run is the same run everywhere, and a failure found once is found again
settings.register_profile("liehom", deadline=None, derandomize=True, print_blob=True)
settings.load_profile("liehom")


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--slow", action="store_true", help="also run the tests marked slow, at full size")


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    if config.getoption("--slow"):
        return
    slow = [item for item in items if item.get_closest_marker("slow")]
    if slow:
        config.hook.pytest_deselected(items=slow)
        items[:] = [item for item in items if not item.get_closest_marker("slow")]
