// SPDX-License-Identifier: Apache-2.0
// Harness of the `pci_bridge` top module: the host on the PCI side, and a memory with random stalls
// on the local bus. Exports the C interface of abi_pci.h.
#include <cstring>
#include <vector>

#include "cde/contract/registers.hpp"
#include "pci_api.h"

namespace {

/// Makes every space a memory. It takes a beat in three of four cycles. Read data come 1 to 8
/// cycles later, in order.
class LocalMemory {
 public:
  static constexpr const char* kKind = "pci_bridge";
  explicit LocalMemory(const cde_pci_options& o) : seed_(o.seed * 2 + 1) {
    for (auto& s : spaces_) s.resize(kBytes / 8);
  }
  void reset() {
    answers_.clear();
    irq_ = false;
  }
  void interrupt(bool level) { irq_ = level; }
  [[nodiscard]] static cde_memory_counters counters() { return {}; }
  static bool asks(const Vmodel&, uint64_t) { return false; }  // there is no DDR
  bool hang(uint32_t) { return false; }
  [[nodiscard]] uint64_t hung() const { return 0; }
  void* memory(uint32_t space, uint64_t& bytes) {
    bytes = space < kSpaces ? kBytes : 0;
    return space < kSpaces ? spaces_[space].data() : nullptr;
  }

  void before(Vmodel& m) {
    seed_ = seed_ * 6364136223846793005ull + 1442695040888963407ull;
    m.bus_ready_i = seed_ >> 62 != 0;
    m.irq_i = irq_;
    ++clock_;
    m.bus_rvalid_i = !answers_.empty() && answers_.front().due <= clock_;
    if (m.bus_rvalid_i) {
      m.bus_rdata_i = answers_.front().data;
      answers_.erase(answers_.begin());
    }
  }
  void at(Vmodel& m) {
    if (!m.bus_valid_o || !m.bus_ready_i || m.rst_i) return;
    uint64_t& word = spaces_[m.bus_space_o][m.bus_addr_o / 8 % (kBytes / 8)];
    if (m.bus_write_o)
      word = m.bus_wdata_o;
    else
      answers_.push_back({clock_ + 1 + (seed_ >> 40) % 8, word});
  }
  void after(Vmodel&) {}

 private:
  static constexpr uint32_t kSpaces = 1u
                                      << cde::card::kSpaceBits;  // spaces of the bus, not of a card
  static constexpr uint64_t kBytes = 4 << 20;
  struct Answer {
    uint64_t due, data;
  };
  std::vector<uint64_t> spaces_[kSpaces];
  std::vector<Answer> answers_;
  uint64_t seed_, clock_ = 0;
  bool irq_ = false;
};

constexpr cde_pci_api kApi = pci::Api<LocalMemory>::table(0, CDE_CONFIG_HASH,
#include "params.inc"
);

}  // namespace

extern "C" __attribute__((visibility("default"))) const cde_pci_api* cde_pci_entry() {
  return &kApi;
}
