// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <span>

#include "cde/wave/trace.hpp"

namespace cde::wave {

/// Streams the values of signals at `from`, then their changes up to and including `to`. This
/// defines a change for all commands. A signal changes if its value at the end of an instant, as
/// written in the file, differs from that at the end of the instant before. A value that is written
/// again is no change. A value that is replaced within its instant is no change either. An event is
/// reported as 1 in each instant in which it is triggered.
void stream_changes(Trace& trace, std::span<const std::uint32_t> handles, std::uint64_t from,
                    std::uint64_t to, const Trace::Visit& visit);

}  // namespace cde::wave
