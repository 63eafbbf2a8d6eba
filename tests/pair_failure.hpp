// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "cde/card/pair_unit.hpp"

/// What a test says and leaves when a pipe answers otherwise than its reference.
namespace cde::testing {

/// Pairs that went through a pipe, and the one in question.
struct FailedPair {
  PairConfig config;
  std::span<const std::uint64_t> a, b;  ///< of all of them
  std::size_t at = 0;
  PairBudget budget = {};
};

/// A command line that asks the pair of the same pipe: "echo '0x... | 0x...' | cde query ...".
[[nodiscard]] std::string query_line(const FailedPair& pair);
/// "explain: cde explain PAIR ... '...'", which `cde explain --from-test` reads.
[[nodiscard]] std::string explain_line(const FailedPair& pair);

/// Packs the first failure of a running test (cde/explain/bundle.hpp): runs the rows around the
/// pair again, and all up to it if that is not enough. Makes a folder build/failures/TEST, or
/// $CDE_FAILURES/TEST. What came of it, for the message of the failure; nothing of a test's second
/// failure.
[[nodiscard]] std::string pack_failure(const FailedPair& pair);

/// Both lines, and what came of packing it.
[[nodiscard]] std::string told_and_packed(const FailedPair& pair);

// ---- What packs a failure, of pairs or of cards (failing_test.cpp) ----

/// "Fp32_PairPipe.EqualsItsReference_sphere_sphere" of the running test.
[[nodiscard]] std::string test_name();
/// $CDE_FAILURES, or failures/ of the build.
[[nodiscard]] std::filesystem::path failures_folder();
/// As one word of a shell.
[[nodiscard]] std::string quoted(const std::string& path);
struct Ran {
  int status = -1;   ///< exit status; -1 if a signal ended it
  std::string said;  ///< on its stdout
};
[[nodiscard]] Ran run_shell(const std::string& command);

}  // namespace cde::testing
