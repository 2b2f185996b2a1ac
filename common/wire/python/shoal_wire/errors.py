# SPDX-License-Identifier: BSD-3-Clause
"""What can be wrong with what others sent or wrote."""


class BadMessage(ValueError):
    """Why a message was refused; `reason` is one of the names that Shoal itself counts by."""

    def __init__(self, reason, detail=""):
        super().__init__(reason + (": " + detail if detail else ""))
        self.reason = reason


class BadFile(ValueError):
    """A file that cannot be read, or holds nothing of ours."""


def require(condition, what, reason="field out of range"):
    if not condition:
        raise BadMessage(reason, what)
