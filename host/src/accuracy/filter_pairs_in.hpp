// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "cde/accuracy/filter_pairs.hpp"

namespace cde::accuracy {

using Words = std::span<const std::uint64_t>;

/// test_certain() in the scalar N. Each build of filter_pairs_in.cpp compiles a few scalars.
template <class N>
struct CertainIn {
  static void test(Pair pair, const PairIterations& iterations, Words a, Words b,
                   std::span<reference::filter::Certain> certain);
};

}  // namespace cde::accuracy
