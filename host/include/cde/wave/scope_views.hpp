// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vector>

#include "cde/wave/request.hpp"

namespace cde::wave {

/// The views of all words, of which each may also be a scope, or a pattern as `ls` takes it: all
/// signals there. No words are all signals. `once` leaves out further names of a signal that is
/// there already, where no word says it in full.
[[nodiscard]] std::vector<View> views_in_scopes(const Request& request, Trace& trace, bool once);

}  // namespace cde::wave
