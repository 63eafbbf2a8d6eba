// SPDX-License-Identifier: Apache-2.0
// Memory of the host: 4 KiB pages whose frames are scattered over the bus address space, as an
// operating system allocates them.
#pragma once
#include <cstdint>
#include <vector>

#include "cde/contract/pci.hpp"
#include "sparse_memory.h"

namespace pci {

constexpr uint64_t kPageBytes = 1 << cde::pci::kPageBits;
constexpr uint32_t kNoFrame = ~0u;

class HostMemory {
 public:
  HostMemory(uint64_t bytes, uint64_t seed)
      : memory_(bytes), page_of_(kFrames, kNoFrame), frame_of_(bytes / kPageBytes) {
    // Frames lie below the top quarter, where devices are. splitmix64 chooses them.
    for (uint32_t page = 0; page < frame_of_.size(); ++page) {
      uint32_t frame = 0;
      do {
        seed += 0x9E3779B97F4A7C15ull;
        uint64_t z = (seed ^ seed >> 30) * 0xBF58476D1CE4E5B9ull;
        z = (z ^ z >> 27) * 0x94D049BB133111EBull;
        frame = static_cast<uint32_t>((z ^ z >> 31) % (kFrames * 3 / 4));
      } while (frame == 0 || page_of_[frame] != kNoFrame);
      page_of_[frame] = page;
      frame_of_[page] = frame;
    }
  }
  [[nodiscard]] uint32_t frame(uint32_t page) const {
    return page < frame_of_.size() ? frame_of_[page] : kNoFrame;
  }
  /// Contents of a frame; null if there is no memory.
  uint8_t* page(uint32_t frame) {
    if (frame >= kFrames || page_of_[frame] == kNoFrame) return nullptr;
    return memory_.at(page_of_[frame] * kPageBytes, kPageBytes);
  }

 private:
  static constexpr uint32_t kFrames = 1u << 20;  // of 32-bit bus addresses
  SparseMemory memory_;
  std::vector<uint32_t> page_of_, frame_of_;
};

}  // namespace pci
