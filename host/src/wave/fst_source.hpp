// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "cde/wave/wave_source.hpp"
#include "wave/fst_blocks.hpp"
#include "wave/wave_bytes.hpp"

namespace cde::wave {

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
  std::vector<bool> frame_;          ///< events whose initial value comes next
  std::unique_ptr<void, void (*)(void*)> reader_;
};

}  // namespace cde::wave
