// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <map>
#include <optional>
#include <string>
#include <tuple>
#include <unordered_map>
#include <vector>

#include "cde/support/text_map.hpp"
#include "cde/wave/design.hpp"
#include "cde/wave/request.hpp"

namespace cde::wave {

/// Values of a design's signals in the waves.
class Sampled {
 public:
  Sampled(Trace& trace, const Design& design);

  [[nodiscard]] std::uint64_t start() const { return trace_.start(); }
  /// Bits at a time; empty if they are not in the waves, under any name that is wired to them.
  [[nodiscard]] std::string bits(const Slice& slice, std::uint64_t time);
  [[nodiscard]] bool has(const Slice& slice);
  /// Reads all of these at once, which is faster than one by one.
  void fetch(const std::vector<Slice>& slices, std::uint64_t time);
  /// The last edge up to and including a time; nothing if there is none, or the signal is missing.
  [[nodiscard]] std::optional<std::uint64_t> last_edge(const ClockEdge& edge, std::uint64_t time);
  /// The time at which the bits got their value of a time; nothing if they never changed.
  [[nodiscard]] std::optional<std::uint64_t> last_change(const Slice& slice, std::uint64_t time);

 private:
  /// Bits of one signal of the waves.
  struct Part {
    std::uint32_t handle = 0;
    std::size_t first = 0, count = 0;  ///< characters of its value
  };
  [[nodiscard]] const std::vector<Part>& parts(const Slice& slice);
  [[nodiscard]] std::vector<Part> find_parts(Slice slice);

  Trace& trace_;
  const Design& design_;
  TextMap<const Signal*> names_;
  std::map<Slice, std::vector<Part>> parts_;  ///< the highest bits first
  std::map<std::uint64_t, std::unordered_map<std::uint32_t, std::string>> values_;
  /// Stretches of time that are read at once (blocks of the file). The changes of one bit are
  /// cached by handle, bit and stretch.
  struct Stretch {
    std::uint64_t from, to;
  };
  using Changes = std::vector<std::pair<std::uint64_t, char>>;
  [[nodiscard]] const Changes& changes(std::uint32_t handle, std::size_t bit, std::size_t stretch);
  std::vector<Stretch> stretches_;
  std::map<std::tuple<std::uint32_t, std::size_t, std::size_t>, Changes> changes_;
};

/// A node in the tree of causes: a signal at a time.
struct Node {
  struct Statement {
    Driver driver;
    std::optional<std::uint64_t> edge;  ///< for a register: when it took its value
    bool held = false;                  ///< it has held the value since that edge
    bool kept = false;  ///< no statement was executed at that edge; the causes are what decided so
    std::vector<std::size_t> causes;  ///< nodes
  };
  Slice slice;   ///< as the statement names it
  Slice driven;  ///< the signal wired to it that the statements assign
  std::uint64_t time = 0;
  unsigned registers = 0;  ///< between it and the root
  /// It decides whether the statement is executed, or which side of its ? : is selected.
  bool condition = false;
  bool in_waves = false, again = false;  ///< again: another node already has its causes
  bool stopped = false;                  ///< a register beyond the depth limit
  std::string value;                     ///< bits
  std::string remark;                    ///< why it has no driver
  std::vector<Statement> statements;
};

/// Causes of the value of some bits at a time, through `depth` registers. At most `lines` nodes are
/// kept, those nearest to the root first.
class Cone {
 public:
  Cone(Trace& trace, Times& times, const Design& design, const Slice& root, std::uint64_t time,
       unsigned depth, Lines& lines);
  /// All nodes, the root first.
  [[nodiscard]] const std::vector<Node>& nodes() const { return nodes_; }

 private:
  struct Waiting {
    std::size_t node;
    std::vector<Driver> all;  ///< drivers regardless of values
    std::optional<std::uint64_t> edge;
    bool is_register = false;
  };
  [[nodiscard]] std::size_t add(const Slice& slice, std::uint64_t time, unsigned registers);
  [[nodiscard]] Waiting prepare(std::size_t node);
  void expand(Waiting& w, std::vector<std::size_t>& next);
  [[nodiscard]] std::optional<std::uint64_t> edge_before(const std::vector<Driver>& drivers,
                                                         std::uint64_t time);
  [[nodiscard]] std::vector<Driver> active(const Waiting& w, std::optional<std::uint64_t> edge,
                                           std::uint64_t time);
  void hold(Waiting& w, std::vector<Driver>& now, bool& held);
  void keep(const Waiting& w, std::vector<std::size_t>& next);

  Times& times_;
  const Design& design_;
  Sampled waves_;
  unsigned depth_, steps_ = 2000;  ///< steps: remaining edges to examine for hidden signals
  Lines& lines_;
  std::vector<Node> nodes_;
  std::map<std::pair<Slice, std::uint64_t>, std::size_t> seen_;
};

}  // namespace cde::wave
