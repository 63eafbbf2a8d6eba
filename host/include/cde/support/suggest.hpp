// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// @file
/// Suggestions for mistyped words.
namespace cde {

inline constexpr std::size_t kLongestTyped = 64;  ///< a longer word is no typing error

/// Damerau-Levenshtein distance: letters replaced, left out, inserted, or two neighbours exchanged.
/// `limit` for all distances from there on. Words whose lengths differ by so much take no time.
[[nodiscard]] std::size_t edit_distance(std::string_view a, std::string_view b, std::size_t limit);

/// The known word nearest to `typed`. At most a third of its letters may be wrong, missing, extra
/// or exchanged with a neighbour; for a short word, one. A known word that begins with `typed` also
/// counts.
[[nodiscard]] std::optional<std::string> nearest_word(std::string_view typed,
                                                      const std::vector<std::string>& known);
[[nodiscard]] std::optional<std::string> nearest_word(std::string_view typed,
                                                      const std::vector<std::string_view>& known);

/// The name that replaced a former option, key or value; empty for any other word.
[[nodiscard]] std::string_view new_name(std::string_view former);

/// Error kUsage if an environment variable with a former name is set. It names the new variable.
void check_environment_names();

/// "did you mean cast?"; for a former name "it is now --iterations"; if nothing is near, "there
/// are: cast, query, ...".
[[nodiscard]] std::string suggestion_text(std::string_view typed,
                                          const std::vector<std::string>& known);

/// Error kUsage "no WHAT 'x'; did you mean y?" if `word` is not in `words`.
void check_known(std::string_view word, const std::vector<std::string>& words,
                 std::string_view what);

}  // namespace cde
