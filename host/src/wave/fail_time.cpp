// SPDX-License-Identifier: Apache-2.0
#include "cde/support/error.hpp"
#include "cde/wave/export.hpp"

namespace cde::wave {

std::optional<std::uint64_t> fail_time(Trace& trace, Times& times) {
  for (const std::string& comment : trace.comments())
    if (comment.starts_with("fail ")) {
      try {
        return times.parse("fail");
      } catch (const Error&) {
        return std::nullopt;
      }
    }
  return std::nullopt;
}

}  // namespace cde::wave
