// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "cde/wave/time.hpp"
#include "cde/wave/trace.hpp"

namespace cde::wave {

/// A signal of one bit as a handshake has it.
struct HandshakeWire {
  std::uint32_t handle = 0;
  std::string name;  ///< in its scope
  bool low = false;  ///< active low, by its name
};

/// Two signals of a scope, or three of PCI, that say together when something is handed over.
struct Handshake {
  std::string name;            ///< "top.core.valid_i/ready_o", where the file has it first
  std::string protocol;        ///< "valid/ready", "req/ack", "pci"
  HandshakeWire valid, ready;  ///< who has something, who takes it; of PCI irdy and trdy
  HandshakeWire frame;         ///< of PCI
  std::uint32_t clock = 0;
  std::string clock_name;
  /// Whether a handshake of another number is behind this one: there are modules between them, each
  /// taking from one and giving to the next. Only of valid/ready and req/ack.
  std::vector<bool> leads_to;
  [[nodiscard]] bool is_pci() const { return frame.handle != 0; }
};

/// A signal called valid without a ready: what goes through a pipe that cannot wait.
struct PipeValid {
  std::string name;
  std::uint32_t handle = 0;
  std::uint32_t clock = 0;
  std::string clock_name;
};

struct Flows {
  std::vector<Handshake> handshakes;
  std::vector<PipeValid> pipes;
};

/// Finds them by their names, in the order of the file, each once however many names it has. A
/// handshake is sampled by `clock` if that was asked for, else by a clock of its scope, or the
/// nearest scope around it that has one; what has none at all is left out.
[[nodiscard]] Flows find_flows(Trace& trace, const std::string& clock);

}  // namespace cde::wave
