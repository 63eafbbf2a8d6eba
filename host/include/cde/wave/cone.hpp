// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <map>
#include <optional>
#include <string>
#include <tuple>
#include <unordered_map>
#include <vector>

#include "cde/wave/design.hpp"
#include "cde/wave/request.hpp"

namespace cde::wave {

/// Values that the waves have of a design's signals.
class Sampled {
 public:
  Sampled(Trace& trace, const Design& design);

  [[nodiscard]] std::uint64_t start() const { return trace_.start(); }
  /// Bits at a time; empty if they are not in the waves, under any name that is wired to them.
  [[nodiscard]] std::string bits(const Slice& slice, std::uint64_t time);
  [[nodiscard]] bool has(const Slice& slice);
  /// Reads all of these at once, which is sooner than one by one.
  void fetch(const std::vector<Slice>& slices, std::uint64_t time);
  /// The last edge up to and with a time; nothing if there is none, or the signal is not there.
  [[nodiscard]] std::optional<std::uint64_t> last_edge(const ClockEdge& edge, std::uint64_t time);
  /// When the bits got the value that they have at a time; nothing if they never changed.
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
  std::unordered_map<std::string, const Signal*> names_;
  std::map<Slice, std::vector<Part>> parts_;  ///< the highest bits first
  std::map<std::uint64_t, std::unordered_map<std::uint32_t, std::string>> values_;
  /// Stretches of time that are read as one, those of the file's blocks, and the changes in them of
  /// one bit: of a handle, the bit, and the stretch.
  struct Stretch {
    std::uint64_t from, to;
  };
  using Changes = std::vector<std::pair<std::uint64_t, char>>;
  [[nodiscard]] const Changes& changes(std::uint32_t handle, std::size_t bit, std::size_t stretch);
  std::vector<Stretch> stretches_;
  std::map<std::tuple<std::uint32_t, std::size_t, std::size_t>, Changes> changes_;
};

/// A signal in the tree of what made another, at a time.
struct Node {
  struct Statement {
    Driver driver;
    std::optional<std::uint64_t> edge;  ///< of a register: when it took its value
    bool held = false;                  ///< it has kept the value since
    bool kept =
        false;  ///< no statement but an edge at which none was executed, and what decided so
    std::vector<std::size_t> causes;  ///< nodes
  };
  Slice slice;   ///< as the statement names it
  Slice driven;  ///< the signal that it is wired to, which the statements assign
  std::uint64_t time = 0;
  unsigned registers = 0;  ///< between it and the root
  /// It decides whether the statement is executed, or which side of its ? : is taken.
  bool condition = false;
  bool in_waves = false, again = false;  ///< again: its causes are those of another node
  bool stopped = false;                  ///< a register behind the last that is looked through
  std::string value;                     ///< bits
  std::string remark;                    ///< why nothing drives it
  std::vector<Statement> statements;
};

/// What made some bits have their value at a time, through `depth` registers; at most `most` nodes,
/// those near to the root first; 0 for all that there are.
class Cone {
 public:
  Cone(Trace& trace, Times& times, const Design& design, const Slice& root, std::uint64_t time,
       unsigned depth, Lines& lines);
  /// The root is the first.
  [[nodiscard]] const std::vector<Node>& nodes() const { return nodes_; }

 private:
  struct Waiting {
    std::size_t node;
    std::vector<Driver> all;  ///< drivers without regard to values
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
  unsigned depth_, steps_ = 2000;  ///< steps: edges that may yet be looked at for what is hidden
  Lines& lines_;
  std::vector<Node> nodes_;
  std::map<std::pair<Slice, std::uint64_t>, std::size_t> seen_;
};

}  // namespace cde::wave
