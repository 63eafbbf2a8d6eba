// SPDX-License-Identifier: Apache-2.0
#include "cde/explain/record.hpp"

#include <fmt/format.h>

#include "cde/support/error.hpp"
#include "explain/record_in.hpp"

namespace cde::explain {

PairRecording record(const PairConfig& config, std::span<const std::uint64_t> a,
                     std::span<const std::uint64_t> b, const PairIterations& iterations) {
  PairRecording recorded;
  const auto in_scalar = [&]<class S>() {
    recorded = RecordIn<S>::record(config, a, b, iterations);
  };
  if (!with_scalar(config.format, in_scalar))
    throw Error(ErrorCode::kUsage,
                fmt::format("pairs have no reference in {}", config.format.name()));
  return recorded;
}

}  // namespace cde::explain
