// SPDX-License-Identifier: Apache-2.0
#include <nanobind/stl/string.h>

#include "cde/support/error.hpp"
#include "cde/support/version.hpp"
#include "native.hpp"

namespace cde::python {
namespace {

const char* name_of(ErrorCode code) {
  switch (code) {
    case ErrorCode::kUsage:
      return "usage";
    case ErrorCode::kFile:
      return "file";
    case ErrorCode::kBadInput:
      return "bad input";
    case ErrorCode::kCapacity:
      return "capacity";
    case ErrorCode::kConfiguration:
      return "configuration";
    case ErrorCode::kBuild:
      return "build";
    case ErrorCode::kDevice:
      return "device";
    case ErrorCode::kMismatch:
      return "mismatch";
    case ErrorCode::kTimeout:
      return "timeout";
    case ErrorCode::kInterrupted:
      break;
  }
  return "interrupted";
}

/// cde.Error(message, code) of the Python part.
void translate(const std::exception_ptr& thrown, void*) {
  try {
    std::rethrow_exception(thrown);
  } catch (const Error& error) {
    const nb::object type = nb::module_::import_("cde._error").attr("Error");
    const nb::object raised = type(error.what(), name_of(error.code()));
    PyErr_SetObject(type.ptr(), raised.ptr());
  }
}

}  // namespace

bool interrupted() {
  const nb::gil_scoped_acquire gil;
  return PyErr_CheckSignals() != 0;
}

}  // namespace cde::python

NB_MODULE(_native, module) {
  namespace python = cde::python;
  python::nb::register_exception_translator(python::translate);
  module.attr("version") = cde::kVersion;
  python::add_pairs(module);
  python::add_rays(module);
}
