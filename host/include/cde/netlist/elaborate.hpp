// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "cde/netlist/netlist.hpp"

/// The RTL as Verilator elaborates it, without a simulation: operators are counted and constants
/// read in the very design that a bitstream is built from.
namespace cde::netlist {

/// What rtl/pipes/pair_pipe.sv says when it is elaborated for a pair that it has no pipe for.
inline constexpr const char* kNoPipe = "no pipe for this pair and algorithm";

/// Instances of the operators in rtl/fp/. One that serves several lanes counts once.
struct Operators {
  unsigned multipliers = 0, dividers = 0, square_roots = 0, adders = 0, subtractors = 0,
           comparators = 0, min_max = 0;
  unsigned mask_ands = 0;  ///< ANDs of two lane masks: in the pipe's own text, and df_wire
  bool operator==(const Operators&) const = default;
};

/// A line of the RTL, and the instance that it makes.
struct Place {
  std::string instance;  ///< its name, behind those of the generate blocks that it is in
  std::string module;    ///< what it is an instance of, as its source names it
  std::string file;      ///< name without folders
  unsigned line = 0;
};

/// What Verilator said, or why it could not be run.
class ElaborationError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The parameter LAT of modules below the tops: clocks of each kind of operator.
[[nodiscard]] std::string latency_parameter(unsigned add, unsigned mul, unsigned div, unsigned sqrt,
                                            unsigned cmp);

/// Whether Verilator reads only the parameters and ports of a module, not its body. The top module
/// is always read whole.
using Hidden = std::function<bool(std::string_view module)>;
/// Hides the gates of the operators.
[[nodiscard]] bool is_gates(std::string_view module);

/// Verilator's XML of module `top` of the RTL in folder `rtl`, whose waivers are in
/// `rtl`/../verilator. Parameters are NAME=VALUE, as the builder of bitstreams takes them; switches
/// are Verilator's. An empty `hidden` hides nothing: that takes as long as Verilator takes for the
/// bitstream. With hidden gates it takes up to a few seconds.
[[nodiscard]] std::string elaborated(const std::filesystem::path& rtl, const std::string& top,
                                     const std::vector<std::string>& parameters,
                                     const Hidden& hidden,
                                     const std::vector<std::string>& switches = {});

/// One elaborated design. Instances are called by their path in the hierarchy, from the top module
/// on and without the names of generate blocks: "pair_pipe.pipe".
class Elaboration {
 public:
  /// Reads the result of elaborated().
  Elaboration(const std::filesystem::path& rtl, const std::string& top,
              const std::vector<std::string>& parameters = {}, const Hidden& hidden = is_gates);

  /// Operators in an instance and all below it; none if there is no such instance.
  [[nodiscard]] Operators operators(const std::string& instance) const;
  /// The lines that make an instance, from below the top module down to it. `path` begins with the
  /// top module and has the names of generate blocks in it, as %m has; it may go on below.
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
      std::string module;  ///< as Verilator calls it, with its parameters
      Line line;
    };
    std::unordered_map<std::string, Part> parts;  ///< instances, with their generate blocks
  };
  void read_cells(const Element& cells);
  void read_body(const Element& element, Module& module, std::vector<std::string>& blocks);
  [[nodiscard]] const Module* find(const std::string& instance) const;

  struct Instance {
    std::string path, module;  ///< those of a generate loop share a path
  };
  std::vector<Instance> instances_;
  std::unordered_map<std::string, std::size_t> by_path_;  ///< the first instance of a path
  std::map<std::string, Module> modules_;
  std::optional<Netlist> netlist_;
};

}  // namespace cde::netlist
