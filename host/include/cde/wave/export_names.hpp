// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "cde/wave/trace.hpp"
#include "cde/wave/value.hpp"

/// @file
/// The nested names of a file, for writers of other files.
namespace cde::wave {

/// Callbacks for names. A scope is reported only if it contains a chosen signal.
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

/// Signals of the views; all without views. Error kUsage if a view has an index; `kind` names the
/// format, which has only whole signals.
[[nodiscard]] std::vector<bool> chosen_signals(Trace& trace, std::span<const View> views,
                                               const std::string& kind);
/// Handles of the chosen signals.
[[nodiscard]] std::vector<std::uint32_t> chosen_handles(Trace& trace,
                                                        const std::vector<bool>& chosen);

}  // namespace cde::wave
