// SPDX-License-Identifier: Apache-2.0
#include "cde/support/error.hpp"

namespace cde {

void throw_usage(const std::string& message) {
  throw Error(ErrorCode::kUsage, message);
}

int exit_status(ErrorCode code) noexcept {
  switch (code) {
    case ErrorCode::kMismatch:
      return 3;
    case ErrorCode::kTimeout:
    case ErrorCode::kDevice:
      return 4;
    default:
      return 2;
  }
}

int exit_status(const Error& error) noexcept {
  return error.code() == ErrorCode::kInterrupted ? 128 + error.signal() : exit_status(error.code());
}

}  // namespace cde
