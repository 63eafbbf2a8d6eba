// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "cde/fp/fp_format.hpp"
#include "cde/wave/trace.hpp"

namespace cde::wave {

/// Text form of a value.
struct Form {
  enum class Kind { kHex, kUnsigned, kSigned, kBinary, kFloat, kNames, kFile };
  Kind kind = Kind::kHex;  ///< kFile: form given in the file, which FileForms looks up
  FpFormat format;         ///< for kFloat
  unsigned lane = 0;       ///< bits per lane; 0: the width of the format, or all bits
  /// For kFloat: a word of all ones, which no operator produces, is a condition.
  bool mask = false;
  std::shared_ptr<const Names> names = {};  ///< for kNames
};

/// Parses "auto" (kFile), "hex", "dec", "signed", "bin", or a number format. "|mask" after a format
/// allows conditions, "/32" sets the bits per lane. Nothing for other texts.
[[nodiscard]] std::optional<Form> parse_form(std::string_view text);
/// Text that parse_form() reads back; "names" for kNames.
[[nodiscard]] std::string form_name(const Form& form);
/// The form, or hex if its lanes do not fit the width.
[[nodiscard]] Form fitting(const Form& form, unsigned width);
/// Selects the form of a signal. If a form other than kFile is asked for, it is that form, where it
/// fits. Otherwise the file decides: by an enumeration, or by its comment `forms PATTERN=FORM
/// PATTERN=FORM*WORDS ...`. The first pattern that matches the name counts; with WORDS the signal
/// must have that many words. Otherwise the form is hex. Error kFile if there are over 1,000
/// patterns, or if comparing them with the names takes too many steps. The constructor reads all
/// comments: make one object per file, not one per signal.
class FileForms {
 public:
  explicit FileForms(Trace& trace);
  [[nodiscard]] Form of(const Signal& signal, const Form& asked) const;

 private:
  struct Rule {
    std::string pattern;
    Form form;
    unsigned words;  ///< 0: any number
  };
  std::vector<Rule> rules_;
  std::string file_;             ///< as messages show it
  mutable std::uint64_t steps_;  ///< comparisons of characters that may follow
};
/// Words that parse_form() reads, for help texts.
[[nodiscard]] std::vector<std::string> form_names();

/// Value of bits 0, 1, x, z in a format; nothing if a bit is x or z.
[[nodiscard]] std::optional<double> number(std::string_view bits, const FpFormat& format);
/// Word of at most 64 bits; nothing if a bit is x or z.
[[nodiscard]] std::optional<std::uint64_t> word(std::string_view bits);

/// A signal or some of its bits, as written by the user: NAME, NAME[3], NAME[7:4], NAME:fp32, or
/// NAME[3]:fp32 for lane 3.
struct View {
  Signal signal;
  std::string label;              ///< as written by the user, with the full name
  unsigned first = 0, width = 0;  ///< characters of a value that are used
  bool indexed = false;           ///< selects bits or a lane
  Form form;

  /// The label without scopes. An escaped name may contain dots.
  [[nodiscard]] std::string_view short_label() const;
  [[nodiscard]] std::string_view bits(std::string_view value) const;
  [[nodiscard]] std::string text(std::string_view value) const;
};

/// Whether a pattern of `*` and `?` matches a name. A pattern without dots may match a name in any
/// scope.
/// `steps`: comparisons that may follow. At 0 the answer is false.
[[nodiscard]] bool matches(std::string_view pattern, std::string_view name, std::uint64_t& steps);
[[nodiscard]] bool matches(std::string_view pattern, std::string_view name);

/// Finds a signal by its name, full or without outer scopes. A suffix #2 selects the second signal
/// of that name in the file. An escaped name may be followed by its blank. Error kUsage if there is
/// none, with similar names, or if several match.
[[nodiscard]] const Signal& find_signal(Trace& trace, std::string_view name);

/// The views of a command-line word; several if it is a pattern. `form` applies to words without a
/// form. Error kUsage.
[[nodiscard]] std::vector<View> views(Trace& trace, const std::string& word, const Form& form);
[[nodiscard]] View view(Trace& trace, const std::string& word, const Form& form);

}  // namespace cde::wave
