// SPDX-License-Identifier: Apache-2.0
#include "options/values.hpp"
#include <CLI/CLI.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "cde/card/board.hpp"
#include "cde/geometry/pair.hpp"
#include "cde/model/model.hpp"
#include "cde/support/error.hpp"
#include "cde/support/message.hpp"
#include "cde/support/output_file.hpp"
#include "cde/support/progress.hpp"
#include "cde/support/read_limits.hpp"
#include "cde/support/suggest.hpp"

namespace cde::cli {
namespace {

/// What an option takes, where CLI11 does not keep it. Options live as long as the program.
std::map<const CLI::Option*, Takes>& registered() {
  static std::map<const CLI::Option*, Takes> all;
  return all;
}

std::string listed(const std::vector<std::string>& words) {
  if (words.size() == 1) return words.front();
  return fmt::format("{} or {}", fmt::join(words.begin(), words.end() - 1, ", "), words.back());
}

CLI::Option* label(CLI::Option* option, Takes what) {
  option->type_name(what.label);
  registered()[option] = std::move(what);
  return option;
}

std::string called(const CLI::Option* option) {
  const auto& all = option->get_lnames();
  return all.empty() ? option->get_name() : "--" + all.front();
}

/// Checks the text before CLI11 converts it to a number, so that there is one message.
template <class Fits>
CLI::Option* check(CLI::Option* option, const std::string& must_be, Fits fits) {
  registered()[option].check = [option, must_be, fits](const std::string& text) {
    if (!fits(text))
      throw Error(ErrorCode::kUsage,
                  fmt::format("{} is {}; it must be {}", called(option), in_quotes(text), must_be));
  };
  return option;
}

template <class Number>
bool reads_as(const std::string& text, Number least, Number most) {
  // CLI11 would read a number that begins with 0 as octal.
  if (std::is_integral_v<Number> && text.size() > 1 && text.front() == '0') return false;
  Number value{};
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && stop == text.data() + text.size() && value >= least &&
         value <= most;
}

/// A clock with or without a unit, or nothing if it is not in the allowed range.
std::optional<double> megahertz(const std::string& text) {
  double value = 0;
  const char* const last = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), last, value);
  if (error != std::errc()) return std::nullopt;
  std::string_view unit(stop, last);
  while (unit.starts_with(' ')) unit.remove_prefix(1);
  constexpr std::pair<std::string_view, double> kUnits[] = {
      {"", 1}, {"MHz", 1}, {"GHz", 1e3}, {"kHz", 1e-3}, {"Hz", 1e-6}};
  for (const auto& [name, factor] : kUnits) {
    if (unit != name) continue;
    value *= factor;
    if (value >= kLeastClockMhz && value <= kMostClockMhz) return value;
  }
  return std::nullopt;
}

std::string in_unit(const std::string& range, const std::string& unit) {
  return unit.empty() ? range : range + " " + unit;
}

}  // namespace

CLI::Option* one_of(CLI::Option* option, std::vector<std::string> words) {
  Takes what{Takes::Kind::kWord, std::move(words), "", {}};
  what.label = fmt::format("{}", fmt::join(what.words, "|"));
  const auto known = what.words;
  label(option, std::move(what));
  return check(option, listed(known), [known](const std::string& text) {
    return std::find(known.begin(), known.end(), text) != known.end();
  });
}

CLI::Option* known_words(CLI::Option* option, std::vector<std::string> words,
                         const std::string& name) {
  return label(option, {Takes::Kind::kWord, std::move(words), name, {}});
}

CLI::Option* named(CLI::Option* option, std::vector<std::string> words, const std::string& name,
                   const std::string& what) {
  known_words(option, words, name);
  registered()[option].check = [words = std::move(words), what](const std::string& text) {
    check_known(text, words, what);
  };
  return option;
}

CLI::Option* pair_value(CLI::Option* option, const std::string& name) {
  known_words(option, pair_names(), name);
  registered()[option].check = [](const std::string& text) { (void)pair_in_any_order(text); };
  return option;
}

void normalise_pairs(std::vector<std::string>& list) {
  for (std::string& text : list) text = name(pair_in_any_order(text).pair);
}

CLI::Option* text_value(CLI::Option* option, const std::string& name,
                        std::function<void(const std::string&)> check) {
  return label(option, {Takes::Kind::kAnything, {}, name, std::move(check)});
}

CLI::Option* flag_value(CLI::Option* flag, std::function<void(const std::string&)> check) {
  return label(flag, {Takes::Kind::kNothing, {}, "", std::move(check)});
}

CLI::Option* number_in(CLI::Option* option, double least, double most, const std::string& unit) {
  const std::string range = in_unit(fmt::format("{:g} to {:g}", least, most), unit);
  option->description(fmt::format("{} ({})", option->get_description(), range));
  label(option, {Takes::Kind::kAnything, {}, "NUMBER", {}});
  return check(option, range, [least, most](const std::string& text) {
    return reads_as<double>(text, least, most);
  });
}

CLI::Option* whole_number_in(CLI::Option* option, std::uint64_t least, std::uint64_t most,
                             const std::string& unit) {
  const std::string range = in_unit(fmt::format("{} to {}", least, most), unit);
  option->description(fmt::format("{} ({})", option->get_description(), range));
  label(option, {Takes::Kind::kAnything, {}, "NUMBER", {}});
  return check(option, "a whole number, " + range, [least, most](const std::string& text) {
    return reads_as<std::uint64_t>(text, least, most);
  });
}

CLI::Option* file_value(CLI::Option* option, const std::string& name) {
  return label(option, {Takes::Kind::kFile, {}, name, {}});
}

CLI::Option* folder_value(CLI::Option* option, const std::string& name) {
  return label(option, {Takes::Kind::kFolder, {}, name, {}});
}

CLI::Option* new_folder_value(CLI::Option* option, const std::string& name) {
  folder_value(option, name);
  registered()[option].check = [option](const std::string& text) {
    if (const auto why = why_no_new_folder(text))
      throw Error(ErrorCode::kUsage, fmt::format("{} {}: {}; expected the name of a new folder",
                                                 called(option), printable_name(text), *why));
  };
  return option;
}

CLI::Option* lanes_value(CLI::Option* option, const std::vector<std::string>& more) {
  std::vector<std::string> words = more;
  for (unsigned lanes = 1; lanes <= 256; lanes *= 2) words.push_back(fmt::to_string(lanes));
  known_words(option, words, more.empty() ? "N" : fmt::format("N|{}", fmt::join(more, "|")));
  return check(option,
               fmt::format("{}a power of two from 1 to 256",
                           more.empty() ? "" : fmt::format("{} or ", fmt::join(more, ", "))),
               [words](const std::string& text) {
                 return std::find(words.begin(), words.end(), text) != words.end();
               });
}

Scene read_scene(const std::string& file, bool quiet, bool named) {
  const Progress busy("loading " + file, quiet);
  return within_memory_for(file, [&] { return named ? load_named_scene(file) : load_scene(file); });
}

void scene_option(CLI::App& verb, std::string& file) {
  check(
      file_value(
          verb.add_option("scene", file, "Scene file, TOML (docs/reference/scenes.md)")->required(),
          "SCENE"),
      "a file; standard input is /dev/stdin (cde run: with --output, because no scene file names "
      "the folder)",
      [](const std::string& text) { return text != "-"; });
}

CLI::Option* clock_option(CLI::App& verb, double& mhz) {
  const std::string range = fmt::format("{:g} to {:g} MHz", kLeastClockMhz, kMostClockMhz);
  CLI::Option* option = verb.add_option(
      "--clock", mhz,
      fmt::format("Core clock assumed instead of the device's ({}), as 1GHz, 250MHz or "
                  "5000kHz; the unit is MHz if none is given",
                  range));
  label(option, {Takes::Kind::kAnything, {}, "CLOCK", {}});
  check(option, range, [](const std::string& text) { return megahertz(text).has_value(); });
  return option->transform([](const std::string& text) {
    const auto value = megahertz(text);
    return value ? fmt::format("{}", *value) : text;
  });
}

void quiet_flag(CLI::App& verb, bool* quiet) {
  verb.add_flag_callback(
      "-q,--quiet",
      [quiet] {
        report_builds(false);
        set_progress_display({});
        if (quiet != nullptr) *quiet = true;
      },
      "No progress");
}

void exact_card_option(CLI::App& verb, bool& exact) {
  verb.add_flag("--exact-card", exact,
                "Use the planned card, even if it must be built first and a built card would do");
}

void deadline_options(CLI::App& verb, std::uint64_t& cycles, double& seconds,
                      const std::string& pass) {
  constexpr std::uint64_t kMost = 1'000'000'000'000'000;
  whole_number_in(
      verb.add_option(
              "--deadline", cycles,
              fmt::format("Device cycles that a {} may take; 0: several times the expected number",
                          pass))
          ->capture_default_str(),
      0, kMost, "cycles");
  number_in(verb.add_option("--timeout", seconds,
                            fmt::format("Wall time that the simulation of a {} may take", pass))
                ->capture_default_str(),
            0.001, 1e6, "s");
}

Takes takes(const CLI::Option& option) {
  if (const auto found = registered().find(&option); found != registered().end())
    return found->second;
  if (option.get_items_expected_max() == 0) return {Takes::Kind::kNothing, {}, "", {}};
  const std::string type = option.get_type_name();
  return {Takes::Kind::kAnything, {}, type.empty() || type == "TEXT" ? "VALUE" : type, {}};
}

std::vector<std::string> names(const CLI::Option& option) {
  std::vector<std::string> all;
  for (const std::string& name : option.get_snames()) all.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) all.push_back("--" + name);
  return all;
}

}  // namespace cde::cli
