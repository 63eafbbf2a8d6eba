// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "cde/wave/wave_source.hpp"
#include "wave/vcd_words.hpp"

namespace cde::wave {

/// $upscope.
struct ScopeEnd {};
using VcdName = std::variant<ScopeName, ScopeEnd, VariableName, Attribute>;

/// What is before $enddefinitions. Handles are numbers of identifiers.
struct VcdHeader {
  int scale = -9;            ///< of a file that does not say it, as other readers have it
  std::uint64_t factor = 1;  ///< of times, where the file's unit is no power of ten
  std::int64_t time_zero = 0;
  std::string writer, date;
  std::vector<VcdName> names;
  std::vector<std::string> identifiers;  ///< of handle 1, 2, ...; several may have one
  std::vector<std::uint32_t> widths;     ///< bits of their values, 0 of texts
  std::vector<int> types;                ///< fstVarType
};

/// Reads a header; error kFile with the line. The reader is behind it then.
[[nodiscard]] VcdHeader read_vcd_header(WordReader& words);
/// Words up to $end, which may lack the blank before it.
[[nodiscard]] std::vector<std::string> vcd_section(WordReader& words, const std::string& name);
/// With blanks between them.
[[nodiscard]] std::string joined(const std::vector<std::string>& words, std::size_t from = 0);

}  // namespace cde::wave
