# SPDX-License-Identifier: Apache-2.0
"""The exception of this package."""


class Error(RuntimeError):
    """What went wrong, as the message says it.

    Attributes:
        code: for programs: "usage", "file", "bad input", "capacity", "configuration", "build",
            "device", "mismatch", "timeout" or "interrupted".
    """

    def __init__(self, message, code="usage"):
        super().__init__(message)
        self.code = code

    def __reduce__(self):
        return Error, (str(self), self.code)
