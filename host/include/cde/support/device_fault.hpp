// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

namespace cde {

/// What the driver knew when an access to the device failed. Part of Error.
struct DeviceFault {
  std::uint32_t code = 0;  ///< pci::Code: from the DMA engine, or how an access of the host ended.
                           ///< 0 if the bus was not involved
  std::uint16_t pci_status = 0;  ///< status register of the card's configuration space. All ones:
                                 ///< the card does not answer. Bus::kFunctional reports 0
  std::uint32_t address = 0;  ///< a transfer's mapped or bus address, an access's offset in BAR0 or
                              ///< configuration space, or a byte address in DDR
  std::uint64_t cycle = 0;    ///< core cycles since power-on; for a PairUnit since its first row
  bool repeatable = false;    ///< the card still works: the pass can be run again
};

}  // namespace cde
