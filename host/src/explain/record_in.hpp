// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "cde/explain/record.hpp"

namespace cde::explain {

/// record() in the scalar S. Each build of record_in.cpp compiles a few scalars.
template <class S>
struct RecordIn {
  static PairRecording record(const PairConfig& config, std::span<const std::uint64_t> a,
                              std::span<const std::uint64_t> b, const PairIterations& iterations);
};

}  // namespace cde::explain
