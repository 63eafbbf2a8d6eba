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

std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::vector<std::size_t>> d(a.size() + 1, std::vector<std::size_t>(b.size() + 1));
  for (std::size_t i = 0; i <= a.size(); ++i) d[i][0] = i;
  for (std::size_t j = 0; j <= b.size(); ++j) d[0][j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    for (std::size_t j = 1; j <= b.size(); ++j) {
      d[i][j] = std::min(
          {d[i - 1][j] + 1, d[i][j - 1] + 1, d[i - 1][j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1)});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        d[i][j] = std::min(d[i][j], d[i - 2][j - 2] + 1);
    }
  }
  return d[a.size()][b.size()];
}

std::optional<std::string> nearest_word(std::string_view typed,
                                        const std::vector<std::string>& known) {
  constexpr std::size_t kLongest = 64;  // longer words are not typing errors
  if (typed.size() < 2 || typed.size() > kLongest) return std::nullopt;
  std::optional<std::string> best;
  std::size_t least = std::max<std::size_t>(1, typed.size() / 3) + 1;
  for (const std::string& word : known) {
    std::size_t d = edit_distance(typed, word);
    if (d != 0 && typed.size() >= 2 && word.starts_with(typed)) d = 1;
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
