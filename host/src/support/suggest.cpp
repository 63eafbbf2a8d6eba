// SPDX-License-Identifier: Apache-2.0
#include "cde/support/suggest.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <utility>

#include "cde/support/error.hpp"
#include "cde/support/message.hpp"

namespace cde {

std::size_t edit_distance(std::string_view a, std::string_view b, std::size_t limit) {
  if (std::max(a.size(), b.size()) - std::min(a.size(), b.size()) >= limit) return limit;
  std::vector<std::size_t> row(b.size() + 1), before(row), before_that(row);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::swap(before_that, before);
    std::swap(before, row);
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      row[j] =
          std::min({before[j] + 1, row[j - 1] + 1, before[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1)});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        row[j] = std::min(row[j], before_that[j - 2] + 1);
    }
  }
  return std::min(row[b.size()], limit);
}

std::optional<std::string> nearest_word(std::string_view typed,
                                        const std::vector<std::string>& known) {
  return nearest_word(typed, std::vector<std::string_view>(known.begin(), known.end()));
}

std::optional<std::string> nearest_word(std::string_view typed,
                                        const std::vector<std::string_view>& known) {
  if (typed.size() < 2 || typed.size() > kLongestTyped) return std::nullopt;
  std::optional<std::string> best;
  std::size_t least = std::max<std::size_t>(1, typed.size() / 3) + 1;
  for (const std::string_view word : known) {
    std::size_t d = edit_distance(typed, word, least);
    if (d != 0 && word.starts_with(typed)) d = 1;
    if (d >= least) continue;
    least = d;
    best = word;
  }
  return best;
}

std::string_view new_name(std::string_view former) {
  struct Renamed {
    std::string_view former, now;
  };
  static constexpr std::array kRenamed = std::to_array<Renamed>({
      {"--budget", "--iterations"},
      {"--budgets", "--iterations"},
      {"--facet-interval", "--sat-interval"},
      {"--verdicts", "--filters"},
      {"budget", "iterations"},
      {"hierarchy", "bvh"},
      {"mover", "transform_site"},
      {"verdicts", "filter"},
  });
  const auto* const found = std::find_if(kRenamed.begin(), kRenamed.end(),
                                         [&](const Renamed& r) { return r.former == former; });
  return found != kRenamed.end() ? found->now : std::string_view();
}

void check_environment_names() {
  for (const auto& [former, now] :
       {std::pair{"CDE_BITSTREAMS", "CDE_MODELS"}, std::pair{"CDE_PRICES", "CDE_COSTS"}})
    if (std::getenv(former) != nullptr)  // NOLINT(concurrency-mt-unsafe)
      throw Error(ErrorCode::kUsage, fmt::format("{}: this variable is now {}; unset it and set {}",
                                                 former, now, now));
}

std::string suggestion_text(std::string_view typed, const std::vector<std::string>& known) {
  const std::string_view now = new_name(typed);
  if (std::find(known.begin(), known.end(), now) != known.end())
    return fmt::format("it is now {}", now);
  const auto near = nearest_word(typed, known);
  return near ? fmt::format("did you mean {}?", *near)
              : fmt::format("there are: {}", fmt::join(known, ", "));
}

void check_known(std::string_view word, const std::vector<std::string>& words,
                 std::string_view what) {
  if (std::find(words.begin(), words.end(), word) == words.end())
    throw Error(ErrorCode::kUsage,
                fmt::format("no {} {}; {}", what, in_quotes(word), suggestion_text(word, words)));
}

}  // namespace cde
