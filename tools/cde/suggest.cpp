#include "suggest.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "help.hpp"
#include "values.hpp"
#include "words.hpp"

namespace cde::cli {
namespace {

/// Damerau and Levenshtein's distance: letters replaced, left out, put in, or two exchanged.
std::size_t distance(std::string_view a, std::string_view b) {
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

std::string meant(const std::optional<std::string>& word) {
  return word ? fmt::format("; did you mean {}?", *word) : std::string();
}

}  // namespace

std::optional<std::string> nearest_word(std::string_view typed,
                                        const std::vector<std::string>& known) {
  constexpr std::size_t kLongest = 64;  // nobody mistypes more than that
  if (typed.empty() || typed.size() > kLongest) return std::nullopt;
  std::optional<std::string> best;
  std::size_t least = std::max<std::size_t>(1, typed.size() / 3) + 1;
  for (const std::string& word : known) {
    std::size_t d = distance(typed, word);
    if (d != 0 && typed.size() >= 2 && word.starts_with(typed)) d = 1;
    if (d >= least) continue;
    least = d;
    best = word;
  }
  return best;
}

std::optional<std::string> unknown_verb(const CLI::App& app,
                                        const std::vector<std::string>& words) {
  const auto typed = std::find_if(words.begin(), words.end(),
                                  [](const std::string& w) { return !w.starts_with('-'); });
  if (typed == words.end()) return std::nullopt;
  std::vector<std::string> known;
  for (const CLI::App* verb : app.get_subcommands([](const CLI::App*) { return true; }))
    if (verb->get_name() == *typed) return std::nullopt;
  for (const CLI::App* verb : shown_verbs(app)) known.push_back(verb->get_name());
  const auto near = nearest_word(*typed, known);
  return fmt::format("no verb {}{}", cli::quoted(*typed),
                     near ? meant(near) : fmt::format("; there are: {}", fmt::join(known, ", ")));
}

std::optional<std::string> left_over(const CLI::App& app) {
  const CLI::App* verb = &app;
  if (const auto parsed = app.get_subcommands(); !parsed.empty()) verb = parsed.front();
  const std::vector<std::string> rest = verb->remaining();
  if (rest.empty()) return std::nullopt;
  const std::string called = verb == &app ? "cde" : "cde " + verb->get_name();
  // An option that nobody knows leaves its value behind, too: it is the option that is wrong.
  const auto option = std::find_if(rest.begin(), rest.end(), [](const std::string& word) {
    return word.size() > 1 && word.front() == '-';
  });
  if (option == rest.end())
    return fmt::format("{} does not know what to do with {}; `{} --help` says what it takes",
                       called, cli::quoted(rest.front()), called);
  const std::string name = option->substr(0, option->find('='));
  std::vector<std::string> known;
  for (const CLI::Option* o : shown_options(*verb, false))
    for (const std::string& other : names(*o)) known.push_back(other);
  const auto near = nearest_word(name, known);
  return fmt::format("{} has no option {}{}", called, cli::quoted(name),
                     near ? meant(near) : fmt::format("; `{} --help` lists them", called));
}

}  // namespace cde::cli
