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

/// Reads wave files (FST), those of `--trace` and others. Error kFile for what is none.
namespace cde::wave {

/// What values are called: bits without zeros in front, name.
using Names = std::map<std::string, std::string, std::less<>>;

struct Signal {
  std::string name;          ///< scopes and name, with dots between
  std::uint32_t handle = 0;  ///< signals with one handle are names of one thing
  unsigned width = 0;        ///< bits; 64 of a real
  int left = 0, right = 0;   ///< of its range as it was declared, e.g. [7:0]
  bool ranged = false, real = false, text = false;
  bool is_signed = false;                   ///< as its kind is in SystemVerilog
  bool event = false;                       ///< 1 in the instants in which it is triggered, else 0
  const char* kind = "";                    ///< "wire", "logic", ...
  const char* direction = "";               ///< "input", "output", ... or empty
  std::shared_ptr<const Names> names = {};  ///< of an enumeration
};

/// A file of waves. Nothing of the changes is kept: they are streamed.
class Trace {
 public:
  explicit Trace(const std::filesystem::path& file);

  [[nodiscard]] const std::filesystem::path& file() const { return file_; }
  [[nodiscard]] const Structure& structure() const { return structure_; }
  /// Times are counted in 10^scale() seconds.
  [[nodiscard]] int scale() const;
  [[nodiscard]] std::uint64_t start() const, end() const;
  [[nodiscard]] std::string writer() const, date() const;
  /// Of all handles.
  [[nodiscard]] std::uint32_t handles() const;

  /// In the order of the file.
  [[nodiscard]] const std::vector<Signal>& signals();
  [[nodiscard]] unsigned scopes();
  /// Comments that the writer left.
  [[nodiscard]] const std::vector<std::string>& comments();

  /// Whether to go on.
  using Visit = std::function<bool(std::uint64_t, std::uint32_t, std::string_view)>;
  /// The values that signals have at `from`, then their changes up to and with `to`, in the order
  /// of time. Bits are characters 0, 1, x, z, the most significant first; reals are decimal text. A
  /// value that a signal does not have yet is x. An event is told of when it is triggered, as 1,
  /// and is 0 at `from` unless it is then.
  void stream(std::span<const std::uint32_t> handles, std::uint64_t from, std::uint64_t to,
              const Visit& visit);

 private:
  void read_names();
  [[noreturn]] void corrupt() const;

  std::filesystem::path file_;
  Structure structure_;
  std::unique_ptr<void, void (*)(void*)> reader_;
  std::optional<std::vector<Signal>> signals_;
  std::vector<std::string> comments_;
  unsigned scopes_ = 0;
  std::vector<unsigned> widths_;  ///< of handles, once the names are read
  std::vector<bool> events_;      ///< handles of events
};

}  // namespace cde::wave
