// SPDX-License-Identifier: Apache-2.0
// Implements the C interface of abi_pci.h with a pci::Bus<Local>.
#pragma once
#include <cstring>
#include <new>

#include "pci_bus.h"

namespace pci {

template <class Local>
struct Api {
  using Card = Bus<Local>;
  static Card& card(void* p) { return *static_cast<Card*>(p); }

  static void* create(const cde_pci_options* o) {
    const bool ok = o->core_period_ps >= 1000 && o->pci_period_ps >= 1000 && o->ddr_latency >= 1 &&
                    o->memory_bytes % kPageBytes == 0 && o->memory_bytes <= 1ull << 30 &&
                    o->profile.read_latency >= 2 && o->profile.write_latency >= 2;
    try {
      return ok ? new Card(*o, Local::kKind) : nullptr;
    } catch (const std::bad_alloc&) {
      return nullptr;
    }
  }
  static int mmio_read(void* p, uint32_t offset, void* data, uint32_t bytes) {
    return card(p).mmio(kMemoryRead, offset, static_cast<uint32_t*>(data), bytes);
  }
  static int mmio_write(void* p, uint32_t offset, const void* data, uint32_t bytes) {
    // access() writes to `data` only what it has read.
    return card(p).mmio(kMemoryWrite, offset, static_cast<uint32_t*>(const_cast<void*>(data)),
                        bytes);
  }

  static int fault(void* p, uint32_t kind, uint32_t count, uint32_t value) {
    const bool known = kind == CDE_PCI_FAULT_HANG ? card(p).local().hang(count)
                                                  : card(p).host().faults().add(kind, count, value);
    return known ? 0 : -1;
  }

  static constexpr cde_pci_api table(uint32_t container_bits, uint64_t config_hash,
                                     const char* parameters) {
    return {
        {CDE_PCI_ABI, sizeof(cde_pci_api)},
        container_bits,
        config_hash,
        parameters,
        create,
        [](void* p) { delete &card(p); },
        [](void* p) { card(p).reset(); },
        mmio_read,
        mmio_write,
        [](void* p, uint32_t offset, uint32_t* value) {
          return card(p).config_read(offset, *value);
        },
        [](void* p, uint32_t offset, uint32_t value) {
          return card(p).config_write(offset, value);
        },
        [](void* p, cde_pci_transaction* t) { return card(p).transact(*t); },
        [](void* p, uint32_t page) { return card(p).host().memory().frame(page); },
        [](void* p, uint32_t frame) -> void* { return card(p).host().memory().page(frame); },
        [](void* p, uint64_t max_ps, int until) { return card(p).run(max_ps, until != 0); },
        [](void* p) { return static_cast<int>(card(p).interrupt()); },
        [](void* p) { return card(p).time_ps(); },
        [](void* p, cde_pci_counters* c) { *c = card(p).counters(); },
        [](void* p, cde_memory_counters* c) { *c = card(p).local().counters(); },
        fault,
        [](void* p) { return card(p).violation(); },
        [](void* p, const cde_trace* what) { return card(p).trace_open(*what); },
        [](void* p) { return card(p).trace_close(); },
        [](void* p, uint32_t space, uint64_t* bytes) -> void* {
          return card(p).local().memory(space, *bytes);
        },
        [](void* p, int level) { card(p).local().interrupt(level != 0); },
        [](void* p, int on) { card(p).evaluate_all(on != 0); },
    };
  }
};

}  // namespace pci
