// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "cde/wave/trace.hpp"

namespace cde::wave {

/// What the transactions of a kind are read from. This table is the one place that knows names of
/// the card's signals; a test holds that the waves of a card have them all.
struct KindSignals {
  std::string_view kind;
  std::string_view what;                 ///< for people
  std::vector<std::string_view> clocks;  ///< at whose rising edges the others are looked at
  /// Below one scope. The first one finds the scope: it is rare.
  std::vector<std::string_view> signals;
  /// With # for indices: as many as there are, at least one.
  std::vector<std::string_view> arrays;
  /// Of a card that has them.
  std::vector<std::string_view> optional;
  /// That such a transaction may have, beside those of all, in their order.
  std::vector<std::string_view> fields;
};

/// In the order in which kinds are told.
[[nodiscard]] const std::vector<KindSignals>& card_signals();

/// What the update engine is seen by: no transactions, but found in the same way.
[[nodiscard]] const KindSignals& tested_signals();

/// An element of an array of signals.
struct Element {
  std::vector<unsigned> indices;  ///< those of the name's #
  const Signal* signal;
};

/// A scope that has the signals of a kind.
struct SignalPlace {
  const KindSignals* of;
  std::string scope;
  std::map<std::string_view, const Signal*> signals;        ///< clocks and optional ones too
  std::map<std::string_view, std::vector<Element>> arrays;  ///< by their indices
};

/// Where a file has the signals of kinds, and what it lacks.
class SignalPlaces {
 public:
  explicit SignalPlaces(Trace& trace);

  /// Scopes that have all signals of a kind.
  [[nodiscard]] std::vector<SignalPlace> of(const KindSignals& kind) const;
  /// What the scope that has the most of them lacks; all of them if no scope has the first.
  [[nodiscard]] std::vector<std::string> missing(const KindSignals& kind) const;

 private:
  [[nodiscard]] std::vector<std::string> scopes(const KindSignals& kind) const;
  [[nodiscard]] SignalPlace place(const KindSignals& kind, const std::string& scope,
                                  std::vector<std::string>& missing) const;

  Trace& trace_;
  std::map<std::string_view, const Signal*> by_name_;
};

}  // namespace cde::wave
