// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "cde/card/board.hpp"

namespace cde::testing {

/// Configurations of boards that several tests use. Each test opens its own board.
BoardConfig host_config();
BoardConfig rtl_config();
/// 4 lanes, slow operators, 1,000 triangles, a ring of 64 records.
BoardConfig small_config();
BoardConfig pci_config();  ///< small_config() behind PCI signals
/// A card on which every call of Board is useful: ray-triangle and triangle-sphere in parallel,
/// objects and check bits. It has 4 lanes, 1,000 triangles and a ring of 64 records.
BoardConfig rich_config(Bus bus);

}  // namespace cde::testing
