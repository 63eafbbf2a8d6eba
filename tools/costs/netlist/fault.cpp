// SPDX-License-Identifier: Apache-2.0
// The number of the planted fault that is switched on: environment variable CDE_NETLIST_FAULT.
#include <cstdlib>

extern "C" int cde_netlist_fault() {
  const char* const number = std::getenv("CDE_NETLIST_FAULT");
  return number != nullptr ? std::atoi(number) : 0;
}
