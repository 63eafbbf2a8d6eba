// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <fmt/format.h>

#include <cstring>

#include "cde/support/error.hpp"

namespace cde {

/// What a bitstream's trace_close answers: 0, or the errno of what could not be written.
inline void require_whole_waves(int error) {
  if (error == 0) return;
  throw Error(ErrorCode::kFile,
              fmt::format("the waves are not whole: {}",
                          std::strerror(error)));  // NOLINT(concurrency-mt-unsafe)
}

}  // namespace cde
