// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// What somebody who mistyped probably meant.
namespace cde {

/// Damerau and Levenshtein's distance: letters replaced, left out, put in, or two exchanged.
[[nodiscard]] std::size_t edit_distance(std::string_view a, std::string_view b);

/// The word nearest to `typed`: at most a third of its letters, and one of a short one, are wrong,
/// missing, too many or exchanged with their neighbour; or it begins with what was typed.
[[nodiscard]] std::optional<std::string> nearest_word(std::string_view typed,
                                                      const std::vector<std::string>& known);

/// "did you mean cast?", or "there are: cast, query, ..." if nothing is near.
[[nodiscard]] std::string meant_or_all(std::string_view typed,
                                       const std::vector<std::string>& known);

/// Error kUsage "no WHAT 'x'; did you mean y?" if the word is none of these.
void must_be_known(std::string_view word, const std::vector<std::string>& words,
                   std::string_view what);

}  // namespace cde
