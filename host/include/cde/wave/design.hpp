// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <compare>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "cde/netlist/netlist.hpp"
#include "cde/wave/trace.hpp"

/// The structure of the design that waves are of, as Verilator elaborates it.
namespace cde::wave {

/// A line of a source, with its text without the spaces around it; empty if the source is not at
/// hand.
struct Place {
  std::string file;  ///< as Verilator was given it
  unsigned line = 0;
  std::string text;
  [[nodiscard]] std::string name() const;  ///< "adder.sv:12", or empty
};

/// Bits of a variable of an instance. Elements of arrays lie behind each other, the lowest index
/// lowest.
struct Slice {
  std::uint32_t unit = 0, variable = 0;
  std::uint64_t low = 0, width = 0;
  auto operator<=>(const Slice&) const = default;
};

/// Values that decide: whether a condition holds, which element an index is. Bits 0, 1, x, z, the
/// most significant first; empty if they are not known.
using Values = std::function<std::string(const Slice&)>;

/// An edge that a register waits for.
struct ClockEdge {
  Slice signal;
  bool rising = true, falling = false;
};

/// One statement that gives a variable its value, or a part of it.
struct Driver {
  enum class Kind {
    kAssign,    ///< of combinational logic, or a latch
    kRegister,  ///< at an edge
    kWire,      ///< a port that is the same as what it is connected to, or as another port
    kPort       ///< a port that an expression is connected to
  };
  Kind kind = Kind::kAssign;
  Place place;
  std::vector<Slice> sources;  ///< what the value is made of, in the order of the text
  /// What decides whether the statement is executed. With values also the conditions of its ? :,
  /// which are among the sources without values.
  std::vector<Slice> controls;
  std::vector<ClockEdge> edges;
  bool sure = true;  ///< with values: it is known to be executed
};

class Design {
 public:
  /// Of Verilator's XML. `file` names it in messages. Sources are files, as the XML names them,
  /// or beside it. Error kFile if it is none.
  Design(std::string xml, std::string file);
  ~Design();
  Design(Design&&) noexcept;
  Design& operator=(Design&&) = delete;

  /// Of the design that `trace` was written by: `structure` is the file of an XML; if it is empty,
  /// the bitstream that the trace names is elaborated, or read from the cache. Error kUsage if the
  /// trace names none, or if the structure is of another design; kBuild if it cannot be elaborated.
  [[nodiscard]] static Design of(Trace& trace, const std::string& structure);

  /// Of a bitstream without waves: its top module and NAME=VALUE. Error kBuild if it cannot be
  /// elaborated.
  [[nodiscard]] static Design of_bitstream(const std::string& kind,
                                           const std::vector<std::string>& parameters);

  /// Like `of`, if it takes no time and nobody is asked: nothing if no structure is named and none
  /// is in the cache. For viewers.
  [[nodiscard]] static std::optional<Design> if_known(Trace& trace, const std::string& structure);

  /// Where the waves have the top module: "board.board", with its own name. Found by `of`.
  [[nodiscard]] const std::string& prefix() const;

  /// Bits of a signal by its whole name in the waves; elements of arrays, [7:4] and members of
  /// structures are parts. Nothing if the design has no such signal.
  [[nodiscard]] std::optional<Slice> find(std::string_view name) const;
  /// Its name in the waves, with the part that it is.
  [[nodiscard]] std::string name(const Slice& slice) const;
  /// The same without the instance that it is in.
  [[nodiscard]] std::string local_name(const Slice& slice) const;
  /// Name of the instance in the waves, with a dot behind it.
  [[nodiscard]] std::string instance(const Slice& slice) const;
  /// The whole name of the variable.
  [[nodiscard]] std::string variable_name(const Slice& slice) const;
  /// Whether it is a variable inside of a process (of a loop, say), or a constant.
  [[nodiscard]] bool is_hidden(const Slice& slice) const;
  /// Whether it is an input of the top module.
  [[nodiscard]] bool is_input(const Slice& slice) const;
  /// Signals of the waves that hold these bits, where `exists` says which names there are: the
  /// variable, or elements and members of it, which the waves may be split into.
  struct Piece {
    std::string name;
    Slice slice;
  };
  [[nodiscard]] std::vector<Piece> pieces(
      const Slice& slice, const std::function<bool(const std::string&)>& exists) const;

  [[nodiscard]] Place declaration(const Slice& slice) const;
  /// What gives these bits their value; with values, what does so now. Nothing for inputs of the
  /// top module and for what is only initialised.
  [[nodiscard]] std::vector<Driver> drivers(const Slice& slice, const Values* values) const;

  /// The same by name, for viewers: lines of the declaration and of all drivers, behind ports.
  struct Places {
    Place declaration;
    std::vector<Place> drivers;
  };
  [[nodiscard]] std::optional<Places> places_of(std::string_view name) const;
  /// Lines of a source, as the design was elaborated from it; empty if it is not at hand.
  [[nodiscard]] const std::vector<std::string>& source(const std::string& file) const;
  void set_source(const std::string& file, const std::string& text);
  /// Sources, as Verilator was given them.
  [[nodiscard]] std::vector<std::string> files() const;

  struct Elaborated;

 private:
  void choose_prefix(Trace& trace);
  [[nodiscard]] std::optional<Slice> find_plainly(std::string_view name) const;
  std::unique_ptr<Elaborated> all_;
};

/// The name of an element without the scope that Verilator 5.048 writes the elements of an array
/// in: top.mem.mem[2] is top.mem[2], top.m.[1].m[1][0] is top.m[1][0]. Others as they are.
[[nodiscard]] std::string without_array_scope(std::string_view name);

/// The line that an element begins in; empty of none.
[[nodiscard]] Place place_of(const Design& design, const netlist::Netlist& netlist,
                             const netlist::Element* e);

}  // namespace cde::wave
