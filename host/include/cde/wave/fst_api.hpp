// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdarg>
#include <exception>

#include "gtkwave/fstapi.h"

namespace cde::wave {

/// The reader of Verilator's runtime met something that it cannot go on with.
struct ReaderFailed : std::exception {
  [[nodiscard]] const char* what() const noexcept override { return "the reader of waves failed"; }
};

}  // namespace cde::wave
