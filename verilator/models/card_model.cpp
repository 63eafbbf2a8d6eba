// SPDX-License-Identifier: Apache-2.0
// Harness of the `card` top module: the host on the PCI side, and DDR and SRAM chips on the other
// side. Exports the C interface of abi_pci.h.
#include "cde/contract/records.hpp"
#include "cde/contract/registers.hpp"
#include "chips.h"
#include "pci_api.h"

namespace {

/// The chips, and the harness's direct access to them.
class BoardSide {
 public:
  static constexpr const char* kKind = "card";
  explicit BoardSide(const cde_pci_options& o)
      : chips_(o.memory, o.ddr_latency, o.core_period_ps) {}
  void reset() { chips_.reset(); }
  static bool asks(const Vmodel& m, uint64_t word) { return Chips::asks(m, word); }
  void before(Vmodel& m) { chips_.before(m); }
  void at(Vmodel& m) { chips_.at(m); }
  void after(Vmodel& m) { chips_.after(m); }
  void interrupt(bool) {}  // the board has its own interrupt
  [[nodiscard]] const cde_memory_counters& counters() const { return chips_.counters(); }
  bool hang(uint32_t cycles) {
    chips_.hang(cycles);
    return true;
  }
  [[nodiscard]] uint64_t hung() const { return chips_.hung(); }
  void* memory(uint32_t space, uint64_t& bytes) {
    SparseMemory* const m = space == cde::card::kSpaceDdr    ? &chips_.ddr()
                            : space == cde::card::kSpaceSram ? &chips_.sram()
                            : space == CDE_PCI_SPACE_CHECK   ? chips_.check()
                                                             : nullptr;
    if (m == nullptr) return nullptr;
    bytes = m->bytes();
    return m->at(0, bytes);
  }

 private:
  Chips chips_;
};

constexpr cde_pci_api kApi = pci::Api<BoardSide>::table(
    8 * sizeof(Vmodel::sram_write_data_o) / cde::card::kRecordWords, CDE_CONFIG_HASH,
#include "params.inc"
);

}  // namespace

extern "C" __attribute__((visibility("default"))) const cde_pci_api* cde_pci_entry() {
  return &kApi;
}
