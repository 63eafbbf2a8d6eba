// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "cde/wave/event.hpp"
#include "cde/wave/expression.hpp"

namespace cde::wave {

/// Follows the changes of a file and reports when an expression is true. Normally that is when it
/// becomes true; if it looks back, at every time it is true. With an edge, it is at edges just
/// before which it is true.
class Follow {
 public:
  /// `when` and `on` may be empty. Error kUsage.
  Follow(Trace& trace, const std::string& what, const std::string& when, const std::string& on);

  /// Views that the expressions read, without duplicates.
  [[nodiscard]] const std::vector<View>& views() const { return views_; }
  /// Their current values as text. While `found` runs, these are the deciding ones.
  [[nodiscard]] std::vector<std::string> texts() const;
  /// Whether an expression looks back at its previous evaluation.
  [[nodiscard]] bool needs_history() const;

  /// Returns whether to continue.
  using Found = std::function<bool(std::uint64_t)>;
  /// Runs from one time to another, both inclusive. A second run continues after the first.
  void run(Trace& trace, std::uint64_t from, std::uint64_t to, const Found& found);

 private:
  void note(const View& v);
  bool step(const Found& found);
  [[nodiscard]] bool edge() const;
  [[nodiscard]] bool evaluate();

  Expression what_;
  std::optional<Expression> when_;
  std::optional<Event> on_;
  std::vector<std::uint32_t> handles_;
  std::vector<View> views_;
  std::vector<std::string> values_;
  std::vector<std::pair<std::uint32_t, std::string>> waiting_;
  std::uint64_t now_ = 0;
  char clock_ = 'x';
  bool begun_ = false, was_ = false;
};

}  // namespace cde::wave
