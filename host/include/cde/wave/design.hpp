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

/// @file
/// The structure of the design of the waves, as Verilator elaborates it.
namespace cde::wave {

/// A source line with its trimmed text. The text is empty if the source is not available.
struct Place {
  std::string file;  ///< as passed to Verilator
  unsigned line = 0;
  std::string text;
  [[nodiscard]] std::string name() const;  ///< "adder.sv:12", or empty
};

/// Bits of a variable of an instance. Array elements are consecutive, the lowest index lowest.
struct Slice {
  std::uint32_t unit = 0, variable = 0;
  std::uint64_t low = 0, width = 0;
  auto operator<=>(const Slice&) const = default;
};

/// Values that decide conditions and indices. Bits 0, 1, x, z, most significant first; empty if
/// unknown.
using Values = std::function<std::string(const Slice&)>;

/// An edge that a register is clocked by.
struct ClockEdge {
  Slice signal;
  bool rising = true, falling = false;
};

/// A statement that assigns a variable or a part of it.
struct Driver {
  enum class Kind {
    kAssign,    ///< combinational logic, or a latch
    kRegister,  ///< at a clock edge
    kWire,      ///< a port that equals its connection or another port
    kPort       ///< a port with an expression as its connection
  };
  Kind kind = Kind::kAssign;
  Place place;
  std::vector<Slice> sources;  ///< signals of the value, in source order
  /// Signals that decide whether the statement is executed. With values they include the conditions
  /// of its ? :, which without values are among the sources.
  std::vector<Slice> controls;
  std::vector<ClockEdge> edges;
  bool sure = true;  ///< with values: it is certainly executed
};

class Design {
 public:
  /// Reads Verilator's XML. `file` names it in messages. Sources are the files that the XML names,
  /// or are beside it. Error kFile if it is not such XML.
  Design(std::string xml, const std::string& file);
  ~Design();
  Design(Design&&) noexcept;
  Design& operator=(Design&&) = delete;

  /// Structure of the design that wrote `trace`. `structure` is an XML file. If it is empty, the
  /// simulation model that the trace names is elaborated, or read from the cache. Error kUsage if
  /// the trace names none, or the structure belongs to another design. Error kBuild if elaboration
  /// fails.
  [[nodiscard]] static Design of(Trace& trace, const std::string& structure);

  /// Structure of a simulation model without waves, from its top module and NAME=VALUE. Error
  /// kBuild if elaboration fails.
  [[nodiscard]] static Design of_model(const std::string& kind,
                                       const std::vector<std::string>& parameters);

  /// Like `of`, but only if it takes no time and no elaboration. Nothing if no structure is named
  /// and none is in the cache. For viewers.
  [[nodiscard]] static std::optional<Design> if_known(Trace& trace, const std::string& structure);

  /// Name of the top module in the waves: "board.board". Found by `of`.
  [[nodiscard]] const std::string& prefix() const;

  /// Bits of a signal by its full name in the waves. Array elements, [7:4] and structure members
  /// select parts. Nothing if the design has no such signal.
  [[nodiscard]] std::optional<Slice> find(std::string_view name) const;
  /// Full name in the waves, with the selected part.
  [[nodiscard]] std::string name(const Slice& slice) const;
  /// The same without the instance.
  [[nodiscard]] std::string local_name(const Slice& slice) const;
  /// Name of the instance in the waves, followed by a dot.
  [[nodiscard]] std::string instance(const Slice& slice) const;
  /// Full name of the variable.
  [[nodiscard]] std::string variable_name(const Slice& slice) const;
  /// Whether it is a variable inside a process (for example of a loop), or a constant.
  [[nodiscard]] bool is_hidden(const Slice& slice) const;
  /// Whether it is an input of the top module.
  [[nodiscard]] bool is_input(const Slice& slice) const;
  /// Signals of the waves that hold these bits; `exists` tells which names the waves have. They are
  /// the variable itself, or the elements and members into which the waves split it.
  struct Piece {
    std::string name;
    Slice slice;
  };
  [[nodiscard]] std::vector<Piece> pieces(
      const Slice& slice, const std::function<bool(const std::string&)>& exists) const;

  [[nodiscard]] Place declaration(const Slice& slice) const;
  /// Drivers of these bits; with values, the active ones. Nothing for inputs of the top module and
  /// for variables that are only initialised.
  [[nodiscard]] std::vector<Driver> drivers(const Slice& slice, const Values* values) const;

  /// The same by name, for viewers: lines of the declaration and of all drivers, through ports.
  struct Places {
    Place declaration;
    std::vector<Place> drivers;
  };
  [[nodiscard]] std::optional<Places> places_of(std::string_view name) const;
  /// Lines of a source as elaborated; empty if it is not available.
  [[nodiscard]] const std::vector<std::string>& source(const std::string& file) const;
  void set_source(const std::string& file, const std::string& text);
  /// Sources as passed to Verilator.
  [[nodiscard]] std::vector<std::string> files() const;

  struct Elaborated;

 private:
  void choose_prefix(Trace& trace);
  [[nodiscard]] std::optional<Slice> find_exact(std::string_view name) const;
  std::unique_ptr<Elaborated> all_;
};

/// The name of an array element without the extra scope of Verilator 5.048. For example,
/// top.mem.mem[2] becomes top.mem[2], and top.m.[1].m[1][0] becomes top.m[1][0]. Other names stay.
[[nodiscard]] std::string without_array_scope(std::string_view name);

/// The line where an element begins; empty for null.
[[nodiscard]] Place place_of(const Design& design, const netlist::Netlist& netlist,
                             const netlist::Element* e);

}  // namespace cde::wave
