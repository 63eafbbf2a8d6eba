// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cde/wave/wave_source.hpp"
#include "wave/fst_blocks.hpp"
#include "wave/wave_bytes.hpp"

namespace cde::wave {

/// Instants at which a writer marked every event because it dumped all values.
class FstEventDumps {
 public:
  explicit FstEventDumps(std::vector<bool> events)
      : events_(std::move(events)), skipped_(events_.size(), kNever) {}
  void add(std::uint64_t time) { times_.push_back(time); }
  void restart() { skipped_.assign(skipped_.size(), kNever); }
  /// Whether this mark of an event is the first in such an instant. Marks that follow it are
  /// triggers.
  bool skips(std::uint64_t time, std::uint32_t handle) {
    if (!events_[handle - 1]) return false;
    std::uint64_t& last = skipped_[handle - 1];
    if (last == time || std::find(times_.begin(), times_.end(), time) == times_.end()) return false;
    last = time;
    return true;
  }

 private:
  static constexpr std::uint64_t kNever = UINT64_MAX;
  std::vector<bool> events_;  ///< by handle
  std::vector<std::uint64_t> times_;
  std::vector<std::uint64_t> skipped_;  ///< per handle, the last instant whose mark was skipped
};

/// FST files, including compressed ones and files that were not closed. The names of an unclosed
/// file are in FILE.hier, where GTKWave's writer keeps them, or in a closed FST of that name.
/// Verilator's reader reads the changes.
class FstSource : public WaveSource {
 public:
  FstSource(WaveBytes file, const std::filesystem::path& path);

  void names(const SourceVisit& visit) override;
  void changes(std::span<const std::uint32_t> handles, std::uint64_t from, std::uint64_t to,
               const Change& visit) override;

 private:
  void unpack();
  void find_names(const std::filesystem::path& path);
  void names_beside(const std::filesystem::path& beside);
  void check_blocks();
  /// Marks the events whose initial value the reader reports first when it reads from `from` on.
  void find_frame(std::uint64_t from, std::span<const std::uint32_t> handles);
  void find_event_dumps();
  void read_changes(std::span<const std::uint32_t> handles, std::uint64_t from, std::uint64_t to,
                    const Change& visit);
  [[nodiscard]] bool has_event(std::span<const std::uint32_t> handles) const;
  void note_facts();
  void open_reader();
  [[noreturn]] void corrupt() const;

  WaveBytes file_;
  bool packed_ = false;
  FstBlocks blocks_;
  std::string names_file_;  ///< the file with the names; empty: this file
  std::string names_;       ///< kept only if they are in another file
  FstWidths widths_;
  std::vector<std::uint32_t> port_;  ///< bits of ports with strengths, by handle
  std::vector<bool> event_;          ///< handles that are events
  std::optional<FstEventDumps> event_dumps_;
  std::vector<bool> frame_;  ///< events whose initial value comes next
  std::unique_ptr<void, void (*)(void*)> reader_;
};

}  // namespace cde::wave
