#pragma once
#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// What somebody who mistyped probably meant.
namespace cde::cli {

/// The word nearest to `typed`: at most a third of its letters, and one of a short one, are wrong,
/// missing, too many or exchanged with their neighbour; or it begins with what was typed.
[[nodiscard]] std::optional<std::string> nearest_word(std::string_view typed,
                                                      const std::vector<std::string>& known);

/// "no verb 'cats'; did you mean cast? ..." if the first word that is no option is no verb.
[[nodiscard]] std::optional<std::string> unknown_verb(const CLI::App& app,
                                                      const std::vector<std::string>& words);

/// "cast has no option --szie; did you mean --size?" about the first thing that a parse left over,
/// in the order typed; nothing if there is none.
[[nodiscard]] std::optional<std::string> left_over(const CLI::App& app);

}  // namespace cde::cli
