// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "cde/wave/time.hpp"
#include "cde/wave/trace.hpp"
#include "cde/wave/value.hpp"

/// @file
/// A query about a wave file: the options of `cde wave`.
namespace cde::wave {

struct Request {
  std::string command, file;
  std::vector<std::string> words;  ///< after the file
  std::string clock, form = "auto", from, to, around, on, when, align = "time";
  std::string where, histogram;
  std::vector<std::string> ignore;
  std::string output;       ///< file of export or serve
  std::string format;       ///< of export
  std::string other;        ///< second file of tui
  std::string structure;    ///< file of Verilator's XML
  std::uint64_t depth = 3;  ///< registers that `why` looks through
  std::uint64_t window = 0, max = 100, columns = 0, ulp = 0;
  double eps = 0;
  bool json = false, ascii = false, first = false, last = false, count = false;
  bool csv = false;

  [[nodiscard]] Form default_form() const;
};

/// The output of `cde wave why`: the cause of a value, or JSON with `request.json`.
[[nodiscard]] std::string why_text(const Request& request);

/// A window of time from --from and --to, or from --around and --window; otherwise the whole file.
/// Option --window counts cycles with a clock, else units of the file.
struct Window {
  std::uint64_t from, to;
};
[[nodiscard]] Window window(const Request& request, Trace& trace, Times& times);

/// The views of all words from `first_word` on.
[[nodiscard]] std::vector<View> views(const Request& request, Trace& trace, std::size_t first_word);
/// Handles of the views.
[[nodiscard]] std::vector<std::uint32_t> handles(const std::vector<View>& views);

/// JSON with schema, version and commit. The schema is "cde.wave.COMMAND.1".
[[nodiscard]] nlohmann::ordered_json begin_json(const Request& request);

/// The text without blanks at line ends.
[[nodiscard]] std::string without_spaces(std::string_view text);

/// Limits the lines of an output to --max and counts the remaining ones. A limit of 0 means no
/// limit.
class Lines {
 public:
  explicit Lines(std::uint64_t most) : most_(most) {}
  /// Counts a line and returns whether it is printed.
  [[nodiscard]] bool next() { return ++seen_ <= most_ || most_ == 0; }
  [[nodiscard]] std::uint64_t more() const {
    return most_ == 0 || seen_ <= most_ ? 0 : seen_ - most_;
  }
  [[nodiscard]] std::uint64_t seen() const { return seen_; }
  /// "... 12 more (--max 0 prints all)", or nothing.
  [[nodiscard]] std::string rest() const;

 private:
  std::uint64_t most_, seen_ = 0;
};

}  // namespace cde::wave
