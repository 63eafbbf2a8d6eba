// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "cde/wave/time.hpp"
#include "cde/wave/trace.hpp"
#include "cde/wave/value.hpp"

/// A question about a wave file, as the options of `cde wave` state it.
namespace cde::wave {

struct Request {
  std::string command, file;
  std::vector<std::string> words;  ///< behind the file
  std::string clock, form = "auto", from, to, around, on, when, align = "time";
  std::string where, histogram;
  std::vector<std::string> ignore;
  std::string output;       ///< file of export or serve
  std::string format;       ///< of export
  std::string other;        ///< second file of tui
  std::string structure;    ///< file of Verilator's XML
  std::uint64_t depth = 3;  ///< registers that why looks through
  std::uint64_t window = 0, max = 100, columns = 0, ulp = 0;
  double eps = 0;
  bool json = false, ascii = false, first = false, last = false, count = false;
  bool csv = false;

  [[nodiscard]] Form default_form() const;
};

/// The text that `cde-wave why` prints: the cause of a value, or JSON with `request.json`.
[[nodiscard]] std::string why_text(const Request& request);

/// A window of time: --from and --to, or --around and --window, which counts cycles if there is a
/// clock, else units of the file; else all of the file.
struct Window {
  std::uint64_t from, to;
};
[[nodiscard]] Window window(const Request& request, Trace& trace, Times& times);

/// The views of all words.
[[nodiscard]] std::vector<View> views(const Request& request, Trace& trace, std::size_t first_word);
/// Their handles.
[[nodiscard]] std::vector<std::uint32_t> handles(const std::vector<View>& views);

/// `schema`, version and commit; the schema is "cde.wave.COMMAND.1".
[[nodiscard]] nlohmann::ordered_json begin_json(const Request& request);

/// Without spaces at the ends of lines.
[[nodiscard]] std::string without_spaces(std::string_view text);

/// Lines with a limit of --max, and how many more there are. A limit of 0 is none.
class Lines {
 public:
  explicit Lines(std::uint64_t most) : most_(most) {}
  /// Whether the next line is printed; it counts.
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
