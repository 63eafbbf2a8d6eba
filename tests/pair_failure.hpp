// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "cde/card/pair_unit.hpp"

/// Message and failure package for a pipe whose answer differs from its reference.
namespace cde::testing {

/// The pairs that went through a pipe, and the pair that failed.
struct FailedPair {
  PairConfig config;
  std::span<const std::uint64_t> a, b;  ///< of all pairs
  std::size_t at = 0;
  PairIterations iterations = {};
};

/// A command line that repeats the pair on the same pipe: "echo '0x... | 0x...' | cde query ...".
[[nodiscard]] std::string query_line(const FailedPair& pair);
/// A line that `cde explain --from-test` reads: "explain: cde explain PAIR ... '...'".
[[nodiscard]] std::string explain_line(const FailedPair& pair);

/// Packs the first failure of a running test (cde/explain/bundle.hpp) into build/failures/TEST, or
/// $CDE_FAILURES/TEST. Repeats the rows around the pair, and all rows up to the pair if the failure
/// does not occur. Returns a line for the failure message: the folder, or why there is none.
/// Returns an empty string for later failures of a test.
/// failure.
[[nodiscard]] std::string pack_failure(const FailedPair& pair);

/// Both lines above, and the line of pack_failure().
[[nodiscard]] std::string failure_report(const FailedPair& pair);

// ---- Support for failure packages of pairs and of cards (failing_test.cpp) ----

/// Name of the running test, such as "Fp32_PairPipe.EqualsItsReference_sphere_sphere".
[[nodiscard]] std::string test_name();
/// $CDE_FAILURES, or failures/ in the build folder.
[[nodiscard]] std::filesystem::path failures_folder();
/// The path as one word of a shell command.
[[nodiscard]] std::string quoted(const std::string& path);
struct Ran {
  int status = -1;   ///< exit status; -1 if a signal ended it
  std::string said;  ///< its stdout
};
[[nodiscard]] Ran run_shell(const std::string& command);

}  // namespace cde::testing
