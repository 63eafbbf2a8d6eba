// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "cde/geometry/pair.hpp"
#include "cde/scene/scene.hpp"
#include "cde/support/suggest.hpp"
#include "options/cli_fwd.hpp"

/// Values of options. Each option states once what it takes; help, manual, completions and check
/// all use that. A value that does not fit is Error kUsage, in the order of the words (typed.hpp).
namespace cde::cli {

/// One of these words: `--mode MODE` of nearest, farthest, ...
CLI::Option* one_of(CLI::Option* option, std::vector<std::string> words);

/// The same without a check; the verb checks the value itself, with a better message. `name` is its
/// name in the help.
CLI::Option* known_words(CLI::Option* option, std::vector<std::string> words,
                         const std::string& name);

/// The same with a check that names the nearest word. `what` is "pair" in "no pair 'x'; did you
/// mean y?".
CLI::Option* named(CLI::Option* option, std::vector<std::string> words, const std::string& name,
                   const std::string& what);
/// The name of a pair, its shapes in either order (pair_in_any_order).
CLI::Option* pair_value(CLI::Option* option, const std::string& name);
/// Replaces each name in `list` by the name in pair_names().
void normalise_pairs(std::vector<std::string>& list);
/// Text of a certain form; `check` throws if the form is wrong. `name` is its name in the help.
CLI::Option* text_value(CLI::Option* option, const std::string& name,
                        std::function<void(const std::string&)> check);

/// A flag with an optional value, which is given only after =.
CLI::Option* flag_value(CLI::Option* flag, std::function<void(const std::string&)> check);

/// A number from `least` to `most`, both included. `unit` may be empty.
CLI::Option* number_in(CLI::Option* option, double least, double most, const std::string& unit);
/// The same for whole numbers.
CLI::Option* whole_number_in(CLI::Option* option, std::uint64_t least, std::uint64_t most,
                             const std::string& unit);

/// A file or folder; completions offer names of existing ones. `name` is its name in the help, e.g.
/// "MESH".
CLI::Option* file_value(CLI::Option* option, const std::string& name);
CLI::Option* folder_value(CLI::Option* option, const std::string& name);
/// A folder that is created under this name, or under this name with a number. Refuses paths that
/// end with . or .. and the root.
CLI::Option* new_folder_value(CLI::Option* option, const std::string& name);

/// Lanes of a card: a power of two. `more` are words that are also allowed.
CLI::Option* lanes_value(CLI::Option* option, const std::vector<std::string>& more = {});

/// --clock: a clock in MHz instead of the device's, as 100, 100MHz or 0.1GHz.
CLI::Option* clock_option(CLI::App& verb, double& mhz);
/// -q: no progress, and models are built without messages. Also sets `quiet`, if it is not null.
void quiet_flag(CLI::App& verb, bool* quiet = nullptr);
/// The scene that a verb reads.
void scene_option(CLI::App& verb, std::string& file);
/// Loads a scene file within its limit of memory (read_limits.hpp), with a line of progress.
/// `named`: another file names it, so it must be regular.
[[nodiscard]] Scene read_scene(const std::string& file, bool quiet, bool named = false);
/// --exact-card: no built card replaces the planned one.
void exact_card_option(CLI::App& verb, bool& exact);
/// The deadline of a pass in device cycles, and the watchdog of the simulation in seconds.
void deadline_options(CLI::App& verb, std::uint64_t& cycles, double& seconds,
                      const std::string& pass);

/// What an option takes, for help and completions.
struct Takes {
  enum class Kind { kNothing, kAnything, kWord, kFile, kFolder };
  Kind kind = Kind::kAnything;
  std::vector<std::string> words;  ///< for kWord
  std::string label;               ///< "FILE", "MHz", "nearest|farthest"; empty for kNothing
  std::function<void(const std::string&)> check;  ///< throws if a value does not fit; may be empty
};
[[nodiscard]] Takes takes(const CLI::Option& option);

/// All names of an option, the short ones first: "-o, --output".
[[nodiscard]] std::vector<std::string> names(const CLI::Option& option);

}  // namespace cde::cli
