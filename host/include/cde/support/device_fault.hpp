// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

namespace cde {

/// What the driver knew when an access to the device failed; part of Error.
struct DeviceFault {
  std::uint32_t code = 0;        ///< pci::Code, of the DMA engine or as an access of the host
                                 ///< ended; 0 where the bus had no part in it
  std::uint16_t pci_status = 0;  ///< status register of the card's configuration space; all ones:
                                 ///< it does not answer, 0: Bus::kFunctional otherwise
  std::uint32_t address = 0;     ///< mapped or bus address of a transfer, offset of an access in
                                 ///< BAR0 or configuration space, byte of DDR
  std::uint64_t clock = 0;       ///< core clocks since power-on, of a PairUnit since the first row
  bool repeatable = false;       ///< the card is well: the pass can be run again
};

}  // namespace cde
