// SPDX-License-Identifier: Apache-2.0
// Timing of reads through rtl/memory/memory_port.sv from a memory of 16 bits that takes an access
// per cycle of the core. Times are cycles of the core. Accesses are served in order.
#pragma once
#include <algorithm>
#include <array>
#include <cstdint>

class NarrowTiming {
 public:
  /// The memory answers `latency` cycles after an access, at least one.
  explicit NarrowTiming(uint64_t latency) : latency_(std::max<uint64_t>(latency, 1)) {}

  void reset() { starts_ = idle_ = reads_ = 0, last_ = {}; }
  /// Whether the port takes an access: the access before it no longer waits.
  [[nodiscard]] bool ready(uint64_t now) const { return now >= starts_; }
  /// When the port delivers a read of so many bytes.
  uint64_t read(uint64_t now, uint64_t bytes) {
    uint64_t& last = last_[reads_++ % kReads];
    last = start(now, bytes / kBytes, last) + latency_;
    return last + 1;
  }
  void write(uint64_t now, uint64_t bytes) { start(now, bytes / kBytes, last_[reads_ % kReads]); }

 private:
  static constexpr uint64_t kBytes = 2;   // per access
  static constexpr uint64_t kReads = 16;  // most reads under way

  /// The cycle of the last access to the memory. `oldest` is when the read that must end first
  /// ends.
  uint64_t start(uint64_t now, uint64_t accesses, uint64_t oldest) {
    starts_ = std::max({now + 2, idle_, oldest + 2});
    idle_ = starts_ + accesses;
    return idle_ - 1;
  }

  const uint64_t latency_;
  uint64_t starts_ = 0;  // cycle of the first access to the memory
  uint64_t idle_ = 0;    // first cycle without one
  uint64_t reads_ = 0;
  std::array<uint64_t, kReads> last_ = {};  // when the last data of a read come
};
