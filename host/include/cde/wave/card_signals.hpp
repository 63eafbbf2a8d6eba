// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "cde/wave/trace.hpp"

namespace cde::wave {

/// Signals from which transactions of a kind are decoded. Only this table knows names of the card's
/// signals. A test checks that the waves of a card have all of them.
struct KindSignals {
  std::string_view kind;
  std::string_view what;                 ///< description for people
  std::vector<std::string_view> clocks;  ///< the other signals are sampled at their rising edges
  /// Signals below one scope. The first one is rare and finds the scope.
  std::vector<std::string_view> signals;
  /// Arrays of signals, with # for indices; at least one element.
  std::vector<std::string_view> arrays;
  /// Signals that a card may lack.
  std::vector<std::string_view> optional;
  /// Fields that such a transaction may have beside the common ones, in their order.
  std::vector<std::string_view> fields;
};

/// All kinds, in the order of the output.
[[nodiscard]] const std::vector<KindSignals>& card_signals();

/// Signals that observe the update engine. They give no transactions, but are found in the same
/// way.
[[nodiscard]] const KindSignals& tested_signals();

/// An element of an array of signals.
struct Element {
  std::vector<unsigned> indices;  ///< indices for the # of the name
  const Signal* signal;
};

/// A scope that has the signals of a kind.
struct SignalPlace {
  const KindSignals* of;
  std::string scope;
  std::map<std::string_view, const Signal*> signals;        ///< also clocks and optional signals
  std::map<std::string_view, std::vector<Element>> arrays;  ///< by their indices
};

/// Where a file has the signals of kinds, and which are missing.
class SignalPlaces {
 public:
  explicit SignalPlaces(Trace& trace);

  /// Scopes that have all signals of a kind.
  [[nodiscard]] std::vector<SignalPlace> of(const KindSignals& kind) const;
  /// Signals missing in the scope that has the most of them; all of them if no scope has the first.
  [[nodiscard]] std::vector<std::string> missing(const KindSignals& kind) const;

 private:
  [[nodiscard]] std::vector<std::string> scopes(const KindSignals& kind) const;
  [[nodiscard]] SignalPlace place(const KindSignals& kind, const std::string& scope,
                                  std::vector<std::string>& missing) const;

  Trace& trace_;
  std::map<std::string_view, const Signal*> by_name_;
};

}  // namespace cde::wave
