// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vector>

#include "cde/wave/request.hpp"

namespace cde::wave {

/// The views of all words. A word may also be a scope or a pattern as in `ls`: all signals that
/// match. Without words: all signals. `once` leaves out further names of a signal, unless a word
/// names them in full.
[[nodiscard]] std::vector<View> views_in_scopes(const Request& request, Trace& trace, bool once);

}  // namespace cde::wave
