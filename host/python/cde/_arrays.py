# SPDX-License-Identifier: Apache-2.0
"""Arrays that the native part takes: rows of float32 or uint32, whose numbers are adjacent."""
import numpy as np

from ._error import Error


def rows(value, name, columns, dtype=np.float32, what=""):
    """`value` as an array of shape (N, columns), and the shape without the last axis.

    An array must have the dtype; other sequences are converted. It is copied only if the numbers of a row are not adjacent, or if rows have
    several distances.
    """
    wanted = f"an array of {np.dtype(dtype).name} with shape (..., {columns})" + (f": {what}" if what else "")
    if isinstance(value, np.ndarray):
        if value.dtype != dtype:
            raise Error(f"{name} is {value.dtype}; expected {wanted}; {name}.astype(np.{np.dtype(dtype).name}) converts it")
        array = value
    else:
        try:
            array = np.asarray(value, dtype=dtype)
        except (TypeError, ValueError, OverflowError) as bad:
            raise Error(f"{name} is {type(value).__name__}, which is no array ({bad}); expected {wanted}") from None
    if array.ndim < 1 or array.shape[-1] != columns:
        raise Error(f"{name} has shape {array.shape}; expected {wanted}")
    leading = array.shape[:-1]
    array = array.reshape(-1, columns)
    size = array.itemsize
    if array.size and (array.strides[1] != size or array.strides[0] % size or array.ctypes.data % size):
        array = np.ascontiguousarray(array)
    return array, leading


def memory_for(count, bytes_each, what):
    """Error, with the bytes, if so many results do not fit into memory."""
    try:
        np.empty(count * bytes_each, np.uint8)
    except (MemoryError, ValueError):
        raise Error(f"{count} {what} take {count * bytes_each / 2**30:.1f} GiB for results, more than there is; ask in parts", "capacity") from None
