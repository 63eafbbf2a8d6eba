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

/// Follows the changes of a file and says where an expression is true: where it becomes so; where
/// it looks back, wherever it is; with an edge, at edges where it is true just before.
class Follow {
 public:
  /// `when` and `on` may be empty. Error kUsage.
  Follow(Trace& trace, const std::string& what, const std::string& when, const std::string& on);

  /// What the expressions read, each once.
  [[nodiscard]] const std::vector<View>& views() const { return views_; }
  /// Their values now, as text: those that decided, while `found` runs.
  [[nodiscard]] std::vector<std::string> texts() const;
  /// An expression looks at what was before the last time that it was looked at.
  [[nodiscard]] bool looks_back() const;

  /// Whether to go on.
  using Found = std::function<bool(std::uint64_t)>;
  /// From one time to another, both within. A second run goes on where the first ended.
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
