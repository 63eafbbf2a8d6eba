// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "cde/wave/structure.hpp"
#include "cde/wave/wave_source.hpp"

/// @file
/// Reads wave files (FST, VCD), written by `--trace` or by other tools. Error kFile for other
/// formats.
namespace cde::wave {

/// Names of values: bits without leading zeros, name.
using Names = std::map<std::string, std::string, std::less<>>;

struct Signal {
  std::string name;          ///< scopes and name, separated by dots
  std::uint32_t handle = 0;  ///< signals with one handle are names of the same signal
  unsigned width = 0;        ///< bits; 64 for a real
  int left = 0, right = 0;   ///< declared range, e.g. [7:0]
  bool ranged = false, real = false, text = false;
  bool is_signed = false;                   ///< as for its kind in SystemVerilog
  bool event = false;                       ///< 1 in the instants in which it is triggered, else 0
  const char* kind = "";                    ///< "wire", "logic", ...
  const char* direction = "";               ///< "input", "output", ... or empty
  std::shared_ptr<const Names> names = {};  ///< names of an enumeration
  /// Number, from 1, among several signals of this name in the file; 0 if it is the only one. From
  /// 2 on `name` ends in #2 and so on; the first is found as NAME#1.
  unsigned number = 0;
};

/// A wave file. Changes are streamed, not stored.
class Trace {
 public:
  explicit Trace(const std::filesystem::path& file);

  [[nodiscard]] const std::filesystem::path& file() const { return file_; }
  [[nodiscard]] const Structure& structure() const { return source_->facts().structure; }
  /// "FST", "VCD", ...
  [[nodiscard]] const std::string& format() const { return source_->facts().format; }
  /// Where an unclosed file ends, and why; empty if the file was closed.
  [[nodiscard]] const std::string& ending() const { return source_->facts().ending; }
  /// Unit of times: 10^scale() seconds.
  [[nodiscard]] int scale() const { return source_->facts().scale; }
  [[nodiscard]] std::uint64_t start() const { return source_->facts().start; }
  [[nodiscard]] std::uint64_t end() const { return source_->facts().end; }
  /// Offset that is added to displayed times ($timezero).
  [[nodiscard]] std::int64_t time_zero() const { return source_->facts().time_zero; }
  /// Times for which the simulation wrote no changes ($dumpoff).
  [[nodiscard]] const std::vector<Blackout>& blackouts() const {
    return source_->facts().blackouts;
  }
  [[nodiscard]] const std::string& writer() const { return source_->facts().writer; }
  [[nodiscard]] const std::string& date() const { return source_->facts().date; }
  /// The largest handle.
  [[nodiscard]] std::uint32_t handles();

  /// All signals in the order of the file. A vector that was written bit by bit is one signal.
  [[nodiscard]] const std::vector<Signal>& signals();
  [[nodiscard]] unsigned scopes();
  /// Comments of the writer.
  [[nodiscard]] const std::vector<std::string>& comments();

  /// Visits scopes, attributes and variables as the file nests them. `variable` also gets the index
  /// of the signal. A vector that was written bit by bit comes once, as a whole.
  struct NestedVisit {
    std::function<void(ScopeName&&)> open;
    std::function<void()> close;
    std::function<void(VariableName&&, std::size_t)> variable;
    std::function<void(Attribute&&)> attribute;
  };
  void nested(const NestedVisit& visit);

  /// Returns whether to continue.
  using Visit = std::function<bool(std::uint64_t, std::uint32_t, std::string_view)>;
  /// Streams the values of signals at `from`, then their changes up to and including `to`, in the
  /// order of time. Bits are characters 0, 1, x, z or another state of the file, most significant
  /// first. Reals are decimal text. A signal without a value yet is x. An event is reported as 1
  /// when it is triggered. At `from` it is 0 unless it is triggered then.
  void stream(std::span<const std::uint32_t> handles, std::uint64_t from, std::uint64_t to,
              const Visit& visit);

 private:
  friend class Changes;
  /// A part of a vector that was written in parts.
  struct Piece {
    std::uint32_t vector = 0;  ///< its handle
    unsigned at = 0;           ///< first character
  };
  void read_names();
  void join_pieces(std::vector<Signal>& found, const std::vector<bool>& begins);
  void number_twins();

  std::filesystem::path file_;
  std::unique_ptr<WaveSource> source_;
  std::optional<std::vector<Signal>> signals_;
  std::vector<std::string> comments_;
  unsigned scopes_ = 0;
  std::vector<unsigned> widths_;                ///< by handle, once the names are read
  std::vector<bool> events_;                    ///< handles of events
  std::vector<std::size_t> signal_of_;          ///< by variable
  std::multimap<std::uint32_t, Piece> pieces_;  ///< by handles of the file
  std::map<std::uint32_t, std::vector<std::uint32_t>> parts_;  ///< of vectors, by their handles
};

}  // namespace cde::wave
