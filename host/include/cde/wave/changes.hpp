// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <span>

#include "cde/wave/trace.hpp"

namespace cde::wave {

/// The values that signals have at `from`, then their changes up to and with `to`. This is what a
/// change is for all commands: at the end of an instant a signal has another value, as the file
/// writes it, than at the end of the instant before. So a value that is written again is none, and
/// neither is one that is gone within its instant. An event is told of, as 1, in each instant in
/// which it is triggered.
void stream_changes(Trace& trace, std::span<const std::uint32_t> handles, std::uint64_t from,
                    std::uint64_t to, const Trace::Visit& visit);

}  // namespace cde::wave
