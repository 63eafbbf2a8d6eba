// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "wave/vcd_words.hpp"

#include "cde/support/text_map.hpp"

namespace cde::wave {

/// Maps identifiers to handles.
class VcdIdentifiers {
 public:
  explicit VcdIdentifiers(const std::vector<std::string>& identifiers);
  /// The first handle of an identifier; 0 if it has none.
  [[nodiscard]] std::uint32_t find(std::string_view identifier) const;
  /// The next handle of the same identifier, or 0.
  [[nodiscard]] std::uint32_t next(std::uint32_t handle) const { return next_[handle]; }

 private:
  std::vector<std::uint32_t> short_;  ///< by number, for short identifiers
  TextMap<std::uint32_t> long_;
  std::vector<std::uint32_t> next_;
};

/// Receives the changes of a VCD file.
class VcdEvents {
 public:
  VcdEvents() = default;
  virtual ~VcdEvents() = default;
  VcdEvents(const VcdEvents&) = delete;
  VcdEvents& operator=(const VcdEvents&) = delete;
  /// Reports a time. False to stop.
  virtual bool time(std::uint64_t now) = 0;
  /// Reports a value. `kind` is b (also for a single bit), r, s or p. `dumped`: a section lists
  /// current values, not changes. False to stop.
  virtual bool change(std::uint32_t handle, char kind, std::string_view value, bool dumped) = 0;
  virtual void dumps(bool) {}
  virtual void comment(std::string) {}
};

/// thrown if the file ends within its last word
struct VcdCut {};

/// Reads the part after $enddefinitions. Error kFile with the line. A problem in the last word of a
/// file that ends without a line feed is VcdCut instead.
class VcdBody {
 public:
  /// Reports times multiplied by `factor`.
  VcdBody(WordReader& words, const VcdIdentifiers& identifiers, std::uint64_t factor)
      : words_(words), identifiers_(identifiers), factor_(factor) {}

  /// Reads to the end, or until the events stop it.
  void run(VcdEvents& events) {
    while (step(events)) {
    }
  }
  /// Reads a word and its arguments; false at the end.
  bool step(VcdEvents& events);
  /// The begin of the last word.
  [[nodiscard]] std::uint64_t offset() const { return offset_; }
  [[nodiscard]] std::uint64_t line() const { return line_; }
  /// Throws VcdCut, or error kFile.
  [[noreturn]] void fail(const std::string& what) const;

 private:
  bool time(VcdEvents& events, std::string_view digits);
  bool change(VcdEvents& events, char kind, std::string_view value, std::string_view identifier);
  bool vector(VcdEvents& events, char kind, std::string_view word);
  bool text(VcdEvents& events, std::string_view word);
  bool port(VcdEvents& events, std::string_view word);
  bool keyword(VcdEvents& events, std::string_view word);
  std::string_view identifier();

  WordReader& words_;
  const VcdIdentifiers& identifiers_;
  std::uint64_t factor_;
  std::string value_;  ///< held while its identifier is read
  bool dumped_ = false;
  std::uint64_t offset_ = 0, line_ = 0;
};

}  // namespace cde::wave
