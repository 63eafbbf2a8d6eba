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

/// What a reader of one file format has to provide. Trace makes signals and values of it.
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
/// A name of a signal as its writer declared it.
struct VariableName {
  int type = 0, direction = 0;  ///< fstVarType, fstVarDir
  std::string name;             ///< with its range, e.g. "count [7:0]"
  std::uint32_t width = 0;      ///< bits; of reals 64, of texts 0
  std::uint32_t handle = 0;     ///< from 1; names with one handle are names of one thing
};

/// What is called for each name, in the order of the file. All text is UTF-8.
struct SourceVisit {
  std::function<void(ScopeName&&)> open;
  std::function<void()> close;
  std::function<void(VariableName&&)> variable;
  std::function<void(Attribute&&)> attribute;
};

struct SourceFacts {
  std::string format;  ///< "FST", "VCD", ...
  int scale = 0;       ///< times are counted in 10^scale seconds
  std::uint64_t start = 0, end = 0;
  std::int64_t time_zero = 0;  ///< people add it to a time
  std::string writer, date;
  std::string ending;         ///< of a file that was not closed: where it ends, and why
  std::uint32_t handles = 0;  ///< the largest
  Structure structure;
  std::vector<Blackout> blackouts;  ///< in the order of time
};

/// A file of waves. Errors are kFile and name the file.
class WaveSource {
 public:
  WaveSource() = default;
  virtual ~WaveSource() = default;
  WaveSource(const WaveSource&) = delete;
  WaveSource& operator=(const WaveSource&) = delete;

  [[nodiscard]] const SourceFacts& facts() const { return facts_; }
  virtual void names(const SourceVisit& visit) = 0;
  /// Whether to go on.
  using Change = std::function<bool(std::uint64_t, std::uint32_t, std::string_view)>;
  /// Changes of handles (sorted, each once) in the order of time: of each the last one at or before
  /// `from`, perhaps after earlier ones, then all up to and with `to`, and perhaps more. Bits are
  /// as many characters as the signal is wide: 0, 1, x, z, or another state as the file has it.
  /// Reals are the shortest decimal that is the same number, texts their bytes. Any value but 0
  /// triggers an event.
  virtual void changes(std::span<const std::uint32_t> handles, std::uint64_t from, std::uint64_t to,
                       const Change& visit) = 0;

 protected:
  SourceFacts facts_;
};

/// Opens a file of a format that is read (FST, VCD), "-" is stdin. Error kFile, which names what
/// converts a file of a known other format.
[[nodiscard]] std::unique_ptr<WaveSource> open_source(const std::filesystem::path& file);

}  // namespace cde::wave
