// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "cde/netlist/netlist.hpp"
#include "cde/support/text_map.hpp"

/// @file
/// The RTL as Verilator elaborates it, without simulation. Operators are counted and constants read
/// in the same design from which a simulation model is built.
namespace cde::netlist {

/// Message of rtl/pipes/pair_pipe.sv when it is elaborated for a pair without a pipe.
inline constexpr const char* kNoPipe = "no pipe for this pair and algorithm";

/// Instances of the operators in rtl/fp/. An operator that serves several lanes counts once.
struct Operators {
  unsigned multipliers = 0, dividers = 0, square_roots = 0, adders = 0, subtractors = 0,
           comparators = 0, min_max = 0;
  unsigned mask_ands = 0;  ///< ANDs of two lane masks: in the pipe's own text, and df_wire
  bool operator==(const Operators&) const = default;
};

/// A line of the RTL that creates an instance.
struct Place {
  std::string instance;  ///< instance name, after the names of its generate blocks
  std::string module;    ///< module of the instance, as its source names it
  std::string file;      ///< name without folders
  unsigned line = 0;
};

/// A message of Verilator, or why Verilator could not run.
class ElaborationError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The parameter LAT of modules below the tops: cycles per kind of operator.
[[nodiscard]] std::string latency_parameter(unsigned add, unsigned mul, unsigned div, unsigned sqrt,
                                            unsigned cmp);

/// Whether Verilator reads only the parameters and ports of a module, not its body. The top module
/// is always read whole.
using Hidden = std::function<bool(std::string_view module)>;
/// Hides the gates of the operators.
[[nodiscard]] bool is_gates(std::string_view module);

/// Verilator's XML of module `top` of the RTL in folder `rtl`, whose waivers are in
/// `rtl`/../verilator. Parameters are NAME=VALUE, as for the builder of simulation models; switches
/// are Verilator's. With hidden gates this takes up to a few seconds. An empty `hidden` hides
/// nothing and takes as long as Verilator takes for the model. With `most_memory` bytes Verilator
/// may take no more, and 120 s of processor time.
[[nodiscard]] std::string elaborated(const std::filesystem::path& rtl, const std::string& top,
                                     const std::vector<std::string>& parameters,
                                     const Hidden& hidden,
                                     const std::vector<std::string>& switches = {},
                                     std::uint64_t most_memory = 0);

/// One elaborated design. Instances are named by their path from the top module, without the names
/// of generate blocks: "pair_pipe.pipe".
class Elaboration {
 public:
  /// Reads the result of elaborated().
  Elaboration(const std::filesystem::path& rtl, const std::string& top,
              const std::vector<std::string>& parameters = {}, const Hidden& hidden = is_gates);

  /// Operators in an instance and below it; none if there is no such instance.
  [[nodiscard]] Operators operators(const std::string& instance) const;
  /// The lines that create an instance, from below the top module down to it. `path` begins with
  /// the top module and includes the names of generate blocks, as %m does. It may continue below
  /// the instance.
  [[nodiscard]] std::vector<Place> places(const std::string& path) const;
  /// Module of an instance, as its source names it; empty if there is no such instance.
  [[nodiscard]] std::string module_of(const std::string& instance) const;
  /// A parameter or localparam of an instance; nothing if it has none of that name.
  [[nodiscard]] std::optional<unsigned> constant(const std::string& instance,
                                                 const std::string& name) const;
  /// Width of a port or signal of an instance, in bits; nothing if it has none of that name.
  [[nodiscard]] std::optional<unsigned> bits(const std::string& instance,
                                             const std::string& signal) const;

 private:
  struct Module {
    std::string source_name;
    std::map<std::string, unsigned> constants;
    std::map<std::string, unsigned> types;  ///< of ports and signals
    unsigned ands = 0;
    struct Part {
      std::string module;  ///< name of Verilator, with its parameters
      Line line;
    };
    TextMap<Part> parts;  ///< instances, with their generate blocks
  };
  void read_cells(const Element& cells);
  void read_body(const Element& element, Module& module, std::vector<std::string>& blocks);
  [[nodiscard]] const Module* find(const std::string& instance) const;

  struct Instance {
    std::string path, module;  ///< instances of a generate loop share a path
  };
  std::vector<Instance> instances_;
  TextMap<std::size_t> by_path_;  ///< first instance of a path
  std::map<std::string, Module> modules_;
  std::optional<Netlist> netlist_;
};

}  // namespace cde::netlist
