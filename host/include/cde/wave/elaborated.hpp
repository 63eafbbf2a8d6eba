// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <sys/types.h>

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
  std::int64_t parent = -1;         ///< unit
  std::uint32_t part = 0;           ///< of the parent's body
  std::vector<std::int64_t> parts;  ///< units of the instances of its body; -1: module missing
};

struct Design::Elaborated {
  explicit Elaborated(std::string xml) : netlist(std::move(xml)) {}

  netlist::Netlist netlist;
  std::string file, prefix;
  /// The user of a structure file of another user than the caller and root: only files of that user
  /// are read as sources.
  std::optional<uid_t> stranger = {};
  std::vector<Body> bodies;
  std::vector<Unit> units;  ///< the top module first
  mutable std::map<std::string, std::vector<std::string>> sources;

  /// The unit's instances below the top module, which is left out; each followed by a dot.
  [[nodiscard]] std::string path(std::uint32_t unit) const;
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
  /// Lines of a source file; empty if it is not available.
  [[nodiscard]] const std::vector<std::string>& source(const std::string& name) const;
  /// The variable that a reference means in a scope of a unit.
  [[nodiscard]] std::optional<Slice> referred(std::uint32_t unit, std::uint32_t scope,
                                              const netlist::Element& reference) const;
};

/// An iteration of a loop: its variable and the variable's value.
struct Turn {
  std::uint32_t variable = 0;
  std::uint64_t number = 0;
};

/// Position of a statement or expression.
struct Context {
  const Design::Elaborated& all;
  std::uint32_t unit = 0, scope = 0;
  const Values* values = nullptr;
  std::optional<Turn> turn = {};
  const Drive* drive = nullptr;  ///< the statement, if it is one of a process
  std::uint32_t place = 0;       ///< number of that drive, or of the first in a guard
};

/// Whether an expression may read bits that had another value within the instant than the waves
/// have. Blocking assignments of the same process change them. A process at an edge is given values
/// from before the edge, any other process the values from the end of the instant.
[[nodiscard]] bool is_passing(const Context& c, const Slice& slice);

constexpr std::uint64_t kMostBits = 1u << 16;  ///< largest expression that is computed

/// Value of an expression. If it is complete, its unknown bits are unknown in the simulation as
/// well. Otherwise some signals are not in the waves, or an operation is not supported.
struct Evaluated {
  Value value;
  bool complete = true;
};
/// Nothing if not even the width is known.
[[nodiscard]] std::optional<Evaluated> evaluate(const Context& c, const netlist::Element& e);
/// Value of an index; nothing if unknown.
[[nodiscard]] std::optional<std::uint64_t> index_value(const Context& c, const netlist::Element* e);
/// Whether the condition of an if holds: 1, 0, or x if unknown. A condition that is x or z in the
/// waves does not hold; it holds if it is the inverse of the source's.
[[nodiscard]] char holds(const Context& c, const netlist::Element& condition, bool swapped = false);
/// The side of ? : that is selected: 1, 0, or x (both) if the condition is x.
[[nodiscard]] char chosen(const Context& c, const netlist::Element& condition);
/// Whether a choice was an if with its else in the source.
[[nodiscard]] bool is_if_else(const Context& c, const netlist::Element& choice);
/// Whether a case item matches, without regard to earlier items: 1, 0 or x.
[[nodiscard]] char is_item(const Context& c, const netlist::Element& choice,
                           const netlist::Element& item);
/// Width of an expression in bits; 0 if unknown.
[[nodiscard]] std::uint64_t width_of(const Context& c, const netlist::Element& e);
/// Bits of a variable that a reference or selection means.
[[nodiscard]] std::optional<Slice> selected(const Context& c, const netlist::Element& e);

/// Collects the signals, with their bits, that bits [low, low + width) of an expression depend on.
/// Those in conditions of ? : go to `selectors` if given.
void collect_sources(const Context& c, const netlist::Element& e, std::uint64_t low,
                     std::uint64_t width, std::vector<Slice>& found,
                     std::vector<Slice>* selectors = nullptr);
/// The same for all bits.
void collect_sources(const Context& c, const netlist::Element& e, std::vector<Slice>& found);

/// The part of the right side that an assignment target takes for some bits of a variable.
struct Overlap {
  std::uint64_t low = 0, width = 0;  ///< bits of the right side
  bool exact = true;                 ///< false: the bits, or whether there are any, are unknown
};
void collect_overlaps(const Context& c, const netlist::Element& target, const Slice& wanted,
                      std::vector<Overlap>& found);

}  // namespace cde::wave
