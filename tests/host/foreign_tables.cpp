// SPDX-License-Identifier: Apache-2.0
// A library with the entry points of every kind of model, tables with only a head, and a `create`
// that reports no memory. A driver meets such a library when it was built from other sources.
#include <cstdint>

#include "cde/abi/abi.h"
#include "cde/abi/abi_fp.h"
#include "cde/abi/abi_pair.h"
#include "cde/abi/abi_pci.h"

namespace {

template <class Api>
Api table(std::uint32_t version) {
  Api api{};
  api.head = {version + CDE_LATER, static_cast<std::uint32_t>(sizeof api + CDE_LONGER)};
  return api;
}

}  // namespace

extern "C" {
const cde_board_api* cde_board_entry() {
  static const cde_board_api api = [] {
    auto made = table<cde_board_api>(CDE_BOARD_ABI);
    made.create = [](const cde_board_options*) -> void* { return nullptr; };
    return made;
  }();
  return &api;
}
const cde_pci_api* cde_pci_entry() {
  static const cde_pci_api api = [] {
    auto made = table<cde_pci_api>(CDE_PCI_ABI);
    made.create = [](const cde_pci_options*) -> void* { return nullptr; };
    return made;
  }();
  return &api;
}
const cde_pair_api* cde_pair_entry() {
  static const cde_pair_api api = table<cde_pair_api>(CDE_PAIR_ABI);
  return &api;
}
const cde_fp_api* cde_fp_entry() {
  static const cde_fp_api api = [] {
    auto made = table<cde_fp_api>(CDE_FP_ABI);
    made.create = []() -> cde_fp_unit* { return nullptr; };
    return made;
  }();
  return &api;
}
}
