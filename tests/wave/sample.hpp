// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "cde/wave/fst_api.hpp"

namespace cde::testing {

/// Writes FST files with Verilator's own writer, in units of ns.
class Writer {
 public:
  explicit Writer(const std::filesystem::path& file);
  ~Writer();
  Writer(const Writer&) = delete;
  Writer& operator=(const Writer&) = delete;

  void scope(const std::string& name);
  void up();
  fstHandle signal(const std::string& name, unsigned width, fstVarType kind = FST_VT_VCD_WIRE);
  fstHandle alias(const std::string& name, unsigned width, fstHandle of);
  void comment(const std::string& text);
  /// Names of the values of the next signal: name, bits.
  void names(const std::vector<std::pair<std::string, std::string>>& values);
  void time(std::uint64_t t);
  /// Ends a block.
  void block();
  void dump(bool on);  ///< $dumpon or $dumpoff
  void set(fstHandle signal, std::uint64_t value);
  void set(fstHandle signal, const std::string& bits);
  void real(fstHandle signal, double value);

 private:
  void* fst_;
  std::vector<unsigned> widths_ = {0};
};

/// Variations of the sample.
struct Sample {
  unsigned late = 0;      ///< units by which everything is later
  unsigned wrong_at = 0;  ///< cycle in which t is one word larger; 0 for none
  unsigned cycles = 20;
};

/// A small card in scope top. Signal clk has 10 ns and rises at 5, 15, ..., and count [7:0] counts
/// its cycles. A handshake has valid and ready. The two fp32 words of data [63:0] are half of the
/// count (lower) and, in cycle 7, a NaN (upper). Until cycle 3, state [2:0] is x. The name
/// core.count is another name of count.
void write_sample(const std::filesystem::path& file, const Sample& sample = {});

/// Copies the design of these waves (top.sv) into a folder, and lets Verilator write its structure
/// there, top.xml.
void write_structure(const std::filesystem::path& folder);

/// Many 32-bit signals s0, s1, ... in scopes of a hundred, with a clock.
void write_large(const std::filesystem::path& file, unsigned signals, unsigned cycles,
                 unsigned changes_per_cycle);

/// A PCI bus as seen by a card's bridge, with a clock of 30 ns. The host writes three words, and
/// one of its reads is retried. The card's read is disconnected; then follow a target abort and a
/// master abort. The card's write has a parity error. A read of the configuration space and an
/// unfinished one end the file.
void write_pci(const std::filesystem::path& file);

}  // namespace cde::testing
