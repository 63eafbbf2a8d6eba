// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <map>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "cde/netlist/netlist.hpp"

/// @file
/// A module of a netlist: its variables, the statements that assign them, and its instances.
namespace cde::wave {

struct Scope {
  int parent = -1;
  std::string prefix;  ///< names of generate blocks, each followed by a dot
  std::map<std::string, std::uint32_t, std::less<>> names;  ///< of variables
};

struct Variable {
  std::string path;  ///< in its module, with generate blocks
  const netlist::Element* declared = nullptr;
  unsigned type = 0;
  bool local = false;  ///< of a loop or function, or a constant
  bool input = false, output = false;
  bool in_process = false;            ///< declared in a process: never a register
  std::vector<std::uint32_t> drives;  ///< statements that assign it, in source order
};

/// A condition for a statement to be executed.
struct Guard {
  enum class Kind { kIf, kElse, kItem, kDefault, kUnknown };
  Kind kind = Kind::kUnknown;
  const netlist::Element* what = nullptr;  ///< condition, or the case statement
  const netlist::Element* item = nullptr;  ///< of the case
  bool swapped = false;     ///< the condition is the inverse of the one in the source
  std::uint32_t first = 0;  ///< number of the first drive in it, or behind it
};

struct Drive {
  const netlist::Element* statement = nullptr;
  const netlist::Element* target = nullptr;
  const netlist::Element* value = nullptr;  ///< null: all `uses` of a call
  const netlist::Element* edges = nullptr;  ///< `<sentree>` of a register
  std::uint32_t scope = 0, process = 0;
  std::vector<Guard> guards;
  bool blocking = false;                   ///< later statements of its process see the value
  const netlist::Element* loop = nullptr;  ///< the outermost that it is in
};

struct Port {
  std::string name;
  const netlist::Element* expression = nullptr;
  bool input = false;
};

struct Part {
  std::string path, module;
  const netlist::Element* declared = nullptr;
  std::uint32_t scope = 0;
  std::vector<Port> ports;
};

struct Function {
  const netlist::Element* declared = nullptr;
  std::uint32_t scope = 0;
};

struct Output {
  std::uint32_t part = 0, port = 0;
};

struct Body {
  std::string name, source_name;
  std::vector<Scope> scopes;
  std::vector<Variable> variables;
  std::vector<Drive> drives;
  std::vector<Part> parts;
  std::vector<std::vector<Output>> outputs;  ///< per variable: ports of instances that drive it
  std::map<std::string, std::uint32_t, std::less<>> by_path, part_by_path;
  std::map<std::string, Function, std::less<>> functions;

  /// The variable that a name means in a scope; -1 if there is none.
  [[nodiscard]] std::int64_t variable(std::uint32_t scope, std::string_view name) const;
};

/// Limits the bytes of all paths and conditions of a structure. Nested blocks with long names would
/// otherwise take a thousand times the file's size.
class BodyBytes {
 public:
  explicit BodyBytes(std::uint64_t file_bytes)
      : most_((std::uint64_t{256} << 20) + 64 * file_bytes), file_(file_bytes) {}
  /// NetlistError if there are too many.
  void add(std::uint64_t bytes);

 private:
  std::uint64_t most_, file_, all_ = 0;
};

/// NetlistError if the limit is reached.
[[nodiscard]] Body read_body(const netlist::Element& module, BodyBytes& bytes);

/// Whether an element is a reference to a variable.
[[nodiscard]] bool is_reference(const netlist::Element& e);
/// Whether an element is a statement, not an expression.
[[nodiscard]] bool is_statement(const netlist::Element& e);
/// Converts half__BRA__1__KET__ to half[1].
[[nodiscard]] std::string with_brackets(std::string text);

}  // namespace cde::wave
