// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "cde/wave/trace.hpp"
#include "cde/wave/value.hpp"

/// The names of a file as its writer nested them, for those who write it again.
namespace cde::wave {

/// What is called for each; a scope only if it has a chosen signal somewhere in it.
struct NameVisit {
  std::function<void(const ScopeName&)> open;
  std::function<void()> close;
  std::function<void(const VariableName&, const Signal&)> signal;
  std::function<void(const Attribute&)> attribute;  ///< comments, enumerations, types of a signal
};
/// `chosen` is parallel to trace.signals().
void visit_names(Trace& trace, const std::vector<bool>& chosen, const NameVisit& visit);

/// The views, or all signals if there are none.
[[nodiscard]] std::vector<View> views_or_all(Trace& trace, std::span<const View> views);

/// Which signals views are of; all if there are none. Error kUsage if a view has an index: `kind`
/// is what has whole signals alone.
[[nodiscard]] std::vector<bool> chosen_signals(Trace& trace, std::span<const View> views,
                                               const std::string& kind);
/// Their handles.
[[nodiscard]] std::vector<std::uint32_t> chosen_handles(Trace& trace,
                                                        const std::vector<bool>& chosen);

}  // namespace cde::wave
