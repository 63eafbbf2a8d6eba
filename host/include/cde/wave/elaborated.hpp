// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "cde/wave/body.hpp"
#include "cde/wave/design.hpp"
#include "cde/wave/four_state.hpp"

namespace cde::wave {

/// An instance of a module.
struct Unit {
  std::uint32_t body = 0;
  std::int64_t parent = -1;  ///< unit
  std::uint32_t part = 0;    ///< of the parent's body
  std::string path;          ///< from the top module on, which is not in it; with a dot behind it
  std::vector<std::int64_t>
      parts;  ///< units of the parts of its body; -1: their module is not there
};

struct Design::Elaborated {
  explicit Elaborated(std::string xml) : netlist(std::move(xml)) {}

  netlist::Netlist netlist;
  std::string file, prefix;
  std::vector<Body> bodies;
  std::vector<Unit> units;  ///< the top first
  mutable std::map<std::string, std::vector<std::string>> sources;

  [[nodiscard]] const Body& body(std::uint32_t unit) const { return bodies[units[unit].body]; }
  [[nodiscard]] const Variable& variable(const Slice& s) const {
    return body(s.unit).variables[s.variable];
  }
  [[nodiscard]] std::uint64_t width(const Slice& s) const {
    return netlist.type(variable(s).type).width;
  }
  [[nodiscard]] Slice whole(std::uint32_t unit, std::uint32_t variable) const {
    Slice s{unit, variable, 0, 0};
    s.width = width(s);
    return s;
  }
  /// Lines of a source file; empty if it is not at hand.
  [[nodiscard]] const std::vector<std::string>& source(const std::string& name) const;
  /// The variable that a reference in a scope of a unit means.
  [[nodiscard]] std::optional<Slice> referred(std::uint32_t unit, std::uint32_t scope,
                                              const netlist::Element& reference) const;
};

/// A turn of a loop: its variable, and what that is.
struct Turn {
  std::uint32_t variable = 0;
  std::uint64_t number = 0;
};

/// Where a statement or an expression stands.
struct Context {
  const Design::Elaborated& all;
  std::uint32_t unit = 0, scope = 0;
  const Values* values = nullptr;
  std::optional<Turn> turn = {};
  const Drive* drive = nullptr;  ///< the statement, if it is one of a process
  std::uint32_t place = 0;       ///< number of that drive, or of the first in a guard
};

/// Whether an expression may read another value of some bits than the waves have: blocking
/// assignments of the same process change them within the instant. A process at an edge is given
/// values from before the edge, any other process those from the end of the instant.
[[nodiscard]] bool is_passing(const Context& c, const Slice& slice);

constexpr std::uint64_t kMostBits = 1u << 16;  ///< of an expression that is computed

/// Value of an expression. What is unknown in it is so in the simulation as well if it is complete;
/// else some of its signals are not in the waves, or what it does is not known here.
struct Evaluated {
  Value value;
  bool complete = true;
};
/// Nothing if not even its width is known.
[[nodiscard]] std::optional<Evaluated> evaluate(const Context& c, const netlist::Element& e);
/// The number that an index is; nothing if it is not known.
[[nodiscard]] std::optional<std::uint64_t> index_value(const Context& c, const netlist::Element* e);
/// Whether the condition of an if holds: 1, 0, or x if it is not known. One that is x or z in the
/// waves does not, or does if it is the inverse of that in the source.
[[nodiscard]] char holds(const Context& c, const netlist::Element& condition, bool swapped = false);
/// Which side of ? : is taken: 1, 0, or x, of both sides, if the condition is x.
[[nodiscard]] char chosen(const Context& c, const netlist::Element& condition);
/// Whether a choice was an if and its else in the source.
[[nodiscard]] bool is_of_if(const Context& c, const netlist::Element& choice);
/// Whether an item of a case statement is the one; items before it are not looked at. 1, 0 or x.
[[nodiscard]] char is_item(const Context& c, const netlist::Element& choice,
                           const netlist::Element& item);
/// Bits of an expression; 0 if it is not known how many.
[[nodiscard]] std::uint64_t width_of(const Context& c, const netlist::Element& e);
/// Bits of a whole variable that a reference or a selection of one is.
[[nodiscard]] std::optional<Slice> selected(const Context& c, const netlist::Element& e);

/// Signals that bits [low, low + width) of an expression are made of, with their bits. Those of the
/// conditions of ? : go to `selectors` if it is given.
void collect_sources(const Context& c, const netlist::Element& e, std::uint64_t low,
                     std::uint64_t width, std::vector<Slice>& found,
                     std::vector<Slice>* selectors = nullptr);
/// All of them.
void collect_sources(const Context& c, const netlist::Element& e, std::vector<Slice>& found);

/// What an expression on the left of an assignment takes of the right for some bits of a variable.
struct Overlap {
  std::uint64_t low = 0, width = 0;  ///< bits of the right
  bool exact = true;                 ///< false: which, or whether any, is not known
};
void collect_overlaps(const Context& c, const netlist::Element& target, const Slice& wanted,
                      std::vector<Overlap>& found);

}  // namespace cde::wave
