// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "cde/wave/structure.hpp"

/// @file
/// Interface of a reader for one file format. Trace builds signals and values from it.
namespace cde::wave {

struct ScopeName {
  int type = 0;  ///< fstScopeType
  std::string name, component;
};
struct Attribute {
  int type = 0, subtype = 0;  ///< fstAttrType, fstMiscType
  std::string name;
  std::uint64_t argument = 0;
};
/// A name of a signal as declared by the writer.
struct VariableName {
  int type = 0, direction = 0;  ///< fstVarType, fstVarDir
  std::string name;             ///< with its range, e.g. "count [7:0]"
  std::uint32_t width = 0;      ///< bits; 64 for reals, 0 for texts
  std::uint32_t handle = 0;     ///< from 1; names with one handle belong to the same signal
};

/// Callbacks for names, in the order of the file. All text is UTF-8.
struct SourceVisit {
  std::function<void(ScopeName&&)> open;
  std::function<void()> close;
  std::function<void(VariableName&&)> variable;
  std::function<void(Attribute&&)> attribute;
};

struct SourceFacts {
  std::string format;  ///< "FST", "VCD", ...
  int scale = 0;       ///< unit of times: 10^scale seconds
  std::uint64_t start = 0, end = 0;
  std::int64_t time_zero = 0;  ///< offset added to displayed times
  std::string writer, date;
  std::string ending;         ///< for an unclosed file: where it ends, and why
  std::uint32_t handles = 0;  ///< the largest handle
  Structure structure;
  std::vector<Blackout> blackouts;  ///< in the order of time
};

/// A wave file. Errors are kFile and name the file.
class WaveSource {
 public:
  WaveSource() = default;
  virtual ~WaveSource() = default;
  WaveSource(const WaveSource&) = delete;
  WaveSource& operator=(const WaveSource&) = delete;

  [[nodiscard]] const SourceFacts& facts() const { return facts_; }
  virtual void names(const SourceVisit& visit) = 0;
  /// Returns whether to continue.
  using Change = std::function<bool(std::uint64_t, std::uint32_t, std::string_view)>;
  /// Visits changes of handles (sorted, unique) in the order of time. For each handle these are the
  /// last change at or before `from`, possibly after earlier ones, then all up to and including
  /// `to`, and possibly more. Bits are as many characters as the signal is wide: 0, 1, x, z, or
  /// another state of the file. Reals are the shortest decimal that gives the same number; texts
  /// are their bytes. Any value but 0 triggers an event.
  virtual void changes(std::span<const std::uint32_t> handles, std::uint64_t from, std::uint64_t to,
                       const Change& visit) = 0;

 protected:
  SourceFacts facts_;
};

/// Opens a file of a supported format (FST, VCD); "-" is stdin. Error kFile for other formats; it
/// names a converter if one is known.
[[nodiscard]] std::unique_ptr<WaveSource> open_source(const std::filesystem::path& file);

}  // namespace cde::wave
