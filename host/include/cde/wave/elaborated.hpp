// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "cde/wave/body.hpp"
#include "cde/wave/design.hpp"

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
};

/// Value of an expression, as far as those of its signals are known: bits as in Values.
[[nodiscard]] std::string evaluate(const Context& c, const netlist::Element& e);
/// Signals that bits [low, low + width) of an expression are made of, with their bits.
void collect_sources(const Context& c, const netlist::Element& e, std::uint64_t low,
                     std::uint64_t width, std::vector<Slice>& found);
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
