// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "cde/wave/time.hpp"
#include "cde/wave/trace.hpp"

namespace cde::wave {

/// A one-bit signal of a handshake.
struct HandshakeWire {
  std::uint32_t handle = 0;
  std::string name;  ///< within its scope
  bool low = false;  ///< active low, judged by its name
};

/// Two signals of a scope, or three of PCI, that together define transfers.
struct Handshake {
  std::string name;            ///< "top.core.valid_i/ready_o": its first name in the file
  std::string protocol;        ///< "valid/ready", "req/ack", "pci"
  HandshakeWire valid, ready;  ///< sender and receiver; for PCI irdy and trdy
  HandshakeWire frame;         ///< PCI only
  std::uint32_t clock = 0;
  std::string clock_name;
  /// Whether the handshake of this number is downstream: modules between them take from one and
  /// give to the next. Only for valid/ready and req/ack.
  std::vector<bool> leads_to;
  [[nodiscard]] bool is_pci() const { return frame.handle != 0; }
};

/// A valid signal without a ready: the valid of a pipe that cannot stall.
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

/// Finds them by name, in the order of the file, once each even if they have several names. A
/// handshake is sampled by `clock` if it is given. Otherwise a clock of its scope or of the nearest
/// enclosing scope samples it. A handshake without any clock is left out.
[[nodiscard]] Flows find_flows(Trace& trace, const std::string& clock);

}  // namespace cde::wave
