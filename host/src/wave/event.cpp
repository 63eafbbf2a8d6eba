// SPDX-License-Identifier: Apache-2.0
#include "cde/wave/event.hpp"

#include <fmt/format.h>

#include "cde/support/error.hpp"
#include "cde/support/message.hpp"
#include "cde/wave/value.hpp"

namespace cde::wave {

Event::Event(Trace& trace, const std::string& text) {
  const std::size_t space = text.find(' ');
  const std::string edge = text.substr(0, space);
  rising = edge == "posedge" || edge == "edge";
  falling = edge == "negedge" || edge == "edge";
  const std::size_t begin = text.find_first_not_of(' ', space);
  if (begin == std::string::npos || space == std::string::npos || (!rising && !falling))
    throw Error(ErrorCode::kUsage,
                fmt::format("--on is {}; it must be 'posedge SIGNAL', 'negedge SIGNAL' or 'edge "
                            "SIGNAL'",
                            in_quotes(text)));
  const Signal& s = find_signal(trace, text.substr(begin));
  if (s.width != 1)
    throw Error(ErrorCode::kUsage,
                fmt::format("--on: {} has {} bits; expected 1", printable_name(s.name), s.width));
  handle = s.handle;
  name = s.name;
}

}  // namespace cde::wave
