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

/// How a value is written.
struct Form {
  enum class Kind { kHex, kUnsigned, kSigned, kBinary, kFloat, kNames, kFile };
  Kind kind = Kind::kHex;  ///< kFile: what the file says, which default_form() looks up
  FpFormat format;         ///< of kFloat
  unsigned lane = 0;       ///< bits of a lane; 0: those of the format, or all
  bool mask = false;       ///< of kFloat: a word of ones, which no operator makes, is a condition
  std::shared_ptr<const Names> names = {};  ///< of kNames
};

/// "auto" (kFile), "hex", "dec", "signed", "bin", or a format of numbers, with "|mask" one that may
/// be a condition; with "/32" the bits of a lane. Nothing if it is none of these.
[[nodiscard]] std::optional<Form> parse_form(std::string_view text);
/// As parse_form reads it; "names" for kNames.
[[nodiscard]] std::string form_name(const Form& form);
/// The form, or hex if such lanes do not fit into as many bits.
[[nodiscard]] Form fitting(const Form& form, unsigned width);
/// How the file says that a signal is written: by the names of its values, or as its comment
/// `forms PATTERN=FORM PATTERN=FORM*WORDS ...` says of the first pattern that names it and, with
/// WORDS, whose so many words it is wide; else hex. Any other form than kFile is the answer itself,
/// where it fits.
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
};
/// Of one signal.
[[nodiscard]] Form default_form(Trace& trace, const Signal& signal, const Form& asked);
/// Words that parse_form takes, for help.
[[nodiscard]] std::vector<std::string> form_names();

/// The value of bits 0, 1, x, z in a format; nothing if one of them is x or z.
[[nodiscard]] std::optional<double> number(std::string_view bits, const FpFormat& format);
/// The word of at most 64 bits, and nothing likewise.
[[nodiscard]] std::optional<std::uint64_t> word(std::string_view bits);

/// A signal, or some bits of it, as they are asked for: NAME, NAME[3], NAME[7:4], NAME:fp32 and
/// NAME[3]:fp32, lane 3.
struct View {
  Signal signal;
  std::string label;              ///< as it was asked for, with its whole name
  unsigned first = 0, width = 0;  ///< characters of a value that are taken
  bool indexed = false;           ///< by bits or a lane
  Form form;

  /// The label without scopes, whose last dot may be one of an escaped name.
  [[nodiscard]] std::string_view short_label() const;
  [[nodiscard]] std::string_view bits(std::string_view value) const;
  [[nodiscard]] std::string text(std::string_view value) const;
};

/// Signals that a pattern of `*` and `?` names, in the order of the file; a pattern without dots
/// may match a name in any scope.
[[nodiscard]] bool matches(std::string_view pattern, std::string_view name);

/// The signal of a name, whole or without outer scopes, with #2 if it is the second of that name in
/// the file; an escaped name may have its blank behind it. Error kUsage if there is none, with near
/// ones, or if several match.
[[nodiscard]] const Signal& find_signal(Trace& trace, std::string_view name);

/// What a word of the command line asks for; several if it is a pattern. `form` is for words that
/// name none. Error kUsage.
[[nodiscard]] std::vector<View> views(Trace& trace, const std::string& word, const Form& form);
[[nodiscard]] View view(Trace& trace, const std::string& word, const Form& form);

}  // namespace cde::wave
