// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "cde/wave/cone.hpp"
#include "cde/wave/design.hpp"
#include "cde/wave/time.hpp"
#include "cde/wave/value.hpp"

namespace cde::wave {

/// Bits of the design that a name means: a signal of the waves in `form`, or one that only the
/// design has, as `plain`. Error kUsage if it is neither.
[[nodiscard]] Slice slice_named(Trace& trace, const Design& design, const std::string& name,
                                const std::string& plain, const Form& form);

/// The cause of a statement that passes its bits on unchanged, if these bits equal `bits`;
/// otherwise nothing. A signal that is not in the waves has the bits of its sources.
[[nodiscard]] std::optional<std::size_t> forwarded_cause(const std::vector<Node>& nodes,
                                                         const std::string& bits,
                                                         const Node::Statement& statement);

/// A signal at a time.
struct Origin {
  std::string signal;  ///< its name in the waves
  std::uint64_t time = 0;
};

/// Where the word that a signal has at a time was produced. It goes back through registers,
/// memories and wires that pass the word on, while the source has the same word before. A word with
/// little information (few bits, or zeros) counts as produced where it is.
[[nodiscard]] Origin origin_of(Trace& trace, Times& times, const Design& design,
                               const Slice& signal, std::uint64_t time);

}  // namespace cde::wave
