// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <ostream>
#include <string>

#include "cde/card/pair_unit.hpp"
#include "cde/geometry/pair.hpp"
#include "cde/model/model.hpp"
#include "cde/query/record.hpp"

/// How GoogleTest prints parameters whose types belong to the library. Structures of a test have a
/// PrintTo of their own. Without one GoogleTest prints their bytes, which the test `names` refuses.
namespace cde {

inline void PrintTo(Pair pair, std::ostream* out) {
  *out << contract::kPairTable.at(static_cast<std::size_t>(pair)).name;
}
inline void PrintTo(Algorithm algorithm, std::ostream* out) {
  *out << name(algorithm);
}
inline void PrintTo(Mode mode, std::ostream* out) {
  *out << name_of(mode);
}
inline void PrintTo(Bus bus, std::ostream* out) {
  *out << (bus == Bus::kCycle ? "PCI" : "functional bus");
}
inline void PrintTo(Arithmetic arithmetic, std::ostream* out) {
  *out << (arithmetic == Arithmetic::kRtl ? "rtl" : "host");
}
inline void PrintTo(const PairConfig& config, std::ostream* out) {
  std::string text;
  for (const std::string& parameter : config.parameters())
    text += (text.empty() ? "" : " ") + parameter;
  *out << text;
}

}  // namespace cde
