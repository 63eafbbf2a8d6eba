// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <functional>

/// @file
/// The native part of the Python package: functions on arrays whose shapes and types the Python
/// part has checked. Outputs are arrays that the caller made.
namespace cde::python {

namespace nb = nanobind;

/// Rows of numbers. Within a row the numbers are adjacent.
template <class T>
using Rows = nb::ndarray<T, nb::ndim<2>, nb::device::cpu>;
/// Adjacent numbers.
template <class T>
using List = nb::ndarray<T, nb::ndim<1>, nb::c_contig, nb::device::cpu>;

/// Whether a signal handler of Python has raised, as at Ctrl-C. Called without the GIL, which it
/// takes for a moment. The exception stays set: throw nb::python_error with the GIL.
[[nodiscard]] bool interrupted();

void add_pairs(nb::module_& module);
void add_rays(nb::module_& module);

}  // namespace cde::python
