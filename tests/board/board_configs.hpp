// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "cde/card/board.hpp"

namespace cde::testing {

/// Boards that the tests share in kind; each call opens a fresh one.
BoardConfig host_config();
BoardConfig rtl_config();
/// 4 lanes, slow operators, 1,000 triangles, ring of 64 records.
BoardConfig small_config();
BoardConfig pci_config();  ///< that of small_config, behind PCI signals
/// 4 lanes, ray-triangle and triangle-sphere at a time, objects, check bits, 1,000 triangles, ring
/// of 64 records: a card on which every call of Board has a meaning.
BoardConfig rich_config(Bus bus);

}  // namespace cde::testing
