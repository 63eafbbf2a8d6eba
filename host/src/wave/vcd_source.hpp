// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "cde/wave/wave_source.hpp"
#include "wave/vcd_body.hpp"
#include "wave/vcd_header.hpp"
#include "wave/vcd_words.hpp"
#include "wave/wave_bytes.hpp"

namespace cde::wave {

/// VCD files. A first pass checks the whole file. At intervals it notes where a time begins and
/// where each signal changed last. A window is then read from near its begin, and memory does not
/// grow with the file.
class VcdSource : public WaveSource {
 public:
  explicit VcdSource(WaveBytes file);

  void names(const SourceVisit& visit) override;
  void changes(std::span<const std::uint32_t> handles, std::uint64_t from, std::uint64_t to,
               const Change& visit) override;

  /// Kinds of values that a signal has had.
  enum Seen : unsigned char { kBits = 1, kReal = 2, kText = 4, kUnknown = 8 };
  /// How values of a handle are read.
  struct Kind {
    bool real = false, text = false, event = false;
    std::uint32_t width = 1;
  };
  /// A place to start from: the first byte of a time.
  struct Point {
    std::uint64_t offset = 0, line = 0, time = 0;
    std::uint64_t before = 0;              ///< the previous time
    std::vector<std::uint64_t> last = {};  ///< by handle: place of its last change; 0: never
  };

 private:
  void settle_kinds(const std::vector<unsigned char>& seen);

  WaveBytes file_;
  std::vector<VcdName> names_;
  std::vector<Kind> kinds_;  ///< by handle
  std::unique_ptr<VcdIdentifiers> identifiers_;
  std::uint64_t factor_ = 1;                ///< of times
  std::uint64_t body_ = 0, body_line_ = 0;  ///< begin of the changes
  std::vector<Point> points_;
};

}  // namespace cde::wave
