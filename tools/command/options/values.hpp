// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "cde/geometry/pair.hpp"
#include "cde/support/suggest.hpp"
#include "options/cli_fwd.hpp"

/// Values of options. What an option takes is said once: the help, the manual, the completions and
/// the check all come from it. A value that does not fit is Error kUsage, in the order of the words
/// (typed.hpp).
namespace cde::cli {

/// One of these words: `--mode MODE` of nearest, farthest, ...
CLI::Option* one_of(CLI::Option* option, std::vector<std::string> words);

/// The same without a check: the verb says more about what is wrong. `name` is how the help calls
/// it.
CLI::Option* known_words(CLI::Option* option, std::vector<std::string> words,
                         const std::string& name);

/// The same with a check that names the nearest: `what` is "pair" in "no pair 'x'; did you mean
/// y?".
CLI::Option* named(CLI::Option* option, std::vector<std::string> words, const std::string& name,
                   const std::string& what);
/// The name of a pair, its shapes in either order (pair_in_any_order).
CLI::Option* pair_value(CLI::Option* option, const std::string& name);
/// `list`, with each name as pair_names() has it.
void settle_pairs(std::vector<std::string>& list);
/// Text of a form: `check` throws if it has another. `name` is how the help calls it.
CLI::Option* text_value(CLI::Option* option, const std::string& name,
                        std::function<void(const std::string&)> check);

/// A flag that may have a value, behind = alone.
CLI::Option* flag_value(CLI::Option* flag, std::function<void(const std::string&)> check);

/// A number between two ends that are both allowed; `unit` may be empty.
CLI::Option* number_in(CLI::Option* option, double least, double most, const std::string& unit);
/// The same for whole numbers.
CLI::Option* whole_number_in(CLI::Option* option, std::uint64_t least, std::uint64_t most,
                             const std::string& unit);

/// A file or folder; the completions offer names of this machine. `name` is how the help calls it,
/// e.g. "MESH".
CLI::Option* file_value(CLI::Option* option, const std::string& name);
CLI::Option* folder_value(CLI::Option* option, const std::string& name);

/// Lanes of a card: a power of two; `more` are words beside the numbers.
CLI::Option* lanes_value(CLI::Option* option, const std::vector<std::string>& more = {});

/// The clock that modelled times assume, in MHz: 100, 100MHz, 0.1GHz.
CLI::Option* clock_option(CLI::App& verb, double& mhz);
/// -q: no progress, and builds of bitstreams go on in silence. Sets `quiet`, too, if there is one.
void quiet_flag(CLI::App& verb, bool* quiet = nullptr);
/// The scene that a verb reads.
void scene_option(CLI::App& verb, std::string& file);
/// No built card in the place of the planned one.
void exact_card_option(CLI::App& verb, bool& exact);
/// The pass's deadline in device clocks and the watchdog of the simulation in seconds.
void deadline_options(CLI::App& verb, std::uint64_t& clocks, double& seconds,
                      const std::string& pass);

/// What an option takes, for those who print or complete it.
struct Takes {
  enum class Kind { kNothing, kAnything, kWord, kFile, kFolder };
  Kind kind = Kind::kAnything;
  std::vector<std::string> words;  ///< of kWord
  std::string label;               ///< "FILE", "MHz", "nearest|farthest"; empty for kNothing
  std::function<void(const std::string&)>
      check;  ///< throws what is wrong with a value; may be none
};
[[nodiscard]] Takes takes(const CLI::Option& option);

/// "--size" with all its names, long ones behind short ones: "-o, --output".
[[nodiscard]] std::vector<std::string> names(const CLI::Option& option);

}  // namespace cde::cli
