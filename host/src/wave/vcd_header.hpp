// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "cde/wave/wave_source.hpp"
#include "wave/vcd_words.hpp"

namespace cde::wave {

/// for $upscope
struct ScopeEnd {};
using VcdName = std::variant<ScopeName, ScopeEnd, VariableName, Attribute>;

/// The part before $enddefinitions. Handles are numbers of identifiers.
struct VcdHeader {
  int scale = -9;            ///< default if the file has no timescale, as in other readers
  std::uint64_t factor = 1;  ///< factor of times, if the file's unit is no power of ten
  std::int64_t time_zero = 0;
  std::string writer, date;
  std::vector<VcdName> names;
  std::vector<std::string> identifiers;  ///< of handle 1, 2, ...; several handles may share one
  std::vector<std::uint32_t> widths;     ///< bits of their values; 0 for texts
  std::vector<int> types;                ///< fstVarType
};

/// Reads a header and leaves the reader behind it. Error kFile with the line.
[[nodiscard]] VcdHeader read_vcd_header(WordReader& words);
/// The words up to $end, which may lack the blank before it.
[[nodiscard]] std::vector<std::string> vcd_section(WordReader& words, const std::string& name);
/// Joins the words with blanks.
[[nodiscard]] std::string joined(const std::vector<std::string>& words, std::size_t from = 0);

}  // namespace cde::wave
