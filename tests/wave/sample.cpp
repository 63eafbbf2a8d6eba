// SPDX-License-Identifier: Apache-2.0
#include "sample.hpp"

#include <fmt/format.h>

#include <bit>
#include <cstdlib>
#include <random>

namespace cde::testing {

Writer::Writer(const std::filesystem::path& file) : fst_(fstWriterCreate(file.c_str(), 1)) {
  if (fst_ == nullptr) throw std::runtime_error("no FST can be written");
  fstWriterSetTimescale(fst_, -9);
  fstWriterSetVersion(fst_, "sample");
  fstWriterSetDate(fst_, "today");
  fstWriterSetPackType(fst_, FST_WR_PT_LZ4);
}
Writer::~Writer() {
  fstWriterClose(fst_);
}
void Writer::scope(const std::string& name) {
  fstWriterSetScope(fst_, FST_ST_VCD_MODULE, name.c_str(), nullptr);
}
void Writer::up() {
  fstWriterSetUpscope(fst_);
}
fstHandle Writer::signal(const std::string& name, unsigned width, fstVarType kind) {
  widths_.push_back(width);
  return fstWriterCreateVar(fst_, kind, FST_VD_IMPLICIT, width, name.c_str(), 0);
}
fstHandle Writer::alias(const std::string& name, unsigned width, fstHandle of) {
  return fstWriterCreateVar(fst_, FST_VT_VCD_WIRE, FST_VD_INPUT, width, name.c_str(), of);
}
void Writer::comment(const std::string& text) {
  fstWriterSetComment(fst_, text.c_str());
}
void Writer::names(const std::vector<std::pair<std::string, std::string>>& values) {
  std::vector<const char*> names, bits;
  for (const auto& [name, value] : values) {
    names.push_back(name.c_str());
    bits.push_back(value.c_str());
  }
  fstWriterEmitEnumTableRef(
      fst_, fstWriterCreateEnumTable(fst_, "names", static_cast<std::uint32_t>(values.size()), 0,
                                     names.data(), bits.data()));
}
void Writer::time(std::uint64_t t) {
  fstWriterEmitTimeChange(fst_, t);
}
void Writer::block() {
  fstWriterFlushContext(fst_);
}
void Writer::dump(bool on) {
  fstWriterEmitDumpActive(fst_, on ? 1 : 0);
}
void Writer::set(fstHandle signal, std::uint64_t value) {
  fstWriterEmitValueChange64(fst_, signal, widths_.at(signal), value);
}
void Writer::set(fstHandle signal, const std::string& bits) {
  fstWriterEmitValueChange(fst_, signal, bits.c_str());
}

void Writer::real(fstHandle signal, double value) {
  fstWriterEmitValueChange(fst_, signal, &value);
}

void write_sample(const std::filesystem::path& file, const Sample& sample) {
  Writer w(file);
  w.comment("fail 75");
  w.scope("top");
  const fstHandle clk = w.signal("clk", 1), count = w.signal("count [7:0]", 8),
                  valid = w.signal("valid", 1), ready = w.signal("ready", 1),
                  data = w.signal("data [63:0]", 64), state = w.signal("state [2:0]", 3);
  w.scope("core");
  w.alias("count [7:0]", 8, count);
  w.up();
  w.up();
  for (unsigned cycle = 0; cycle < sample.cycles; ++cycle) {
    w.time(10ull * cycle + (cycle == 0 ? 0 : sample.late));
    w.set(clk, 0);
    w.time(10ull * cycle + 5 + sample.late);
    w.set(clk, 1);
    w.set(count, cycle);
    w.set(valid, cycle % 4 != 0);
    w.set(ready, cycle % 2);
    std::uint32_t low = std::bit_cast<std::uint32_t>(static_cast<float>(cycle) / 2);
    if (sample.wrong_at != 0 && cycle == sample.wrong_at) ++low;
    const std::uint32_t high = cycle == 7 ? 0x7fc00000 : 0x3f800000;
    w.set(data, std::uint64_t{high} << 32 | low);
    if (cycle >= 3) w.set(state, cycle % 3);
  }
}

void write_structure(const std::filesystem::path& folder) {
  std::filesystem::copy_file(std::string(CDE_SOURCE_DIR) + "/tests/wave/top.sv", folder / "top.sv");
  const std::string command =
      "cd '" + folder.string() +
      "' && verilator -O0 --xml-only --xml-output top.xml --top-module top top.sv >log 2>&1";
  if (std::system(command.c_str()) != 0) throw std::runtime_error("verilator: no structure");
}

void write_large(const std::filesystem::path& file, unsigned signals, unsigned cycles,
                 unsigned changes_per_cycle) {
  Writer w(file);
  w.scope("top");
  const fstHandle clk = w.signal("clk", 1);
  std::vector<fstHandle> all;
  for (unsigned i = 0; i < signals; ++i) {
    if (i % 100 == 0) {
      if (i != 0) w.up();
      w.scope(fmt::format("unit{}", i / 100));
    }
    all.push_back(w.signal(fmt::format("s{} [31:0]", i), 32));
  }
  w.up();
  w.up();
  std::mt19937 random(14);
  for (unsigned cycle = 0; cycle < cycles; ++cycle) {
    w.time(10ull * cycle);
    w.set(clk, 0);
    w.time(10ull * cycle + 5);
    w.set(clk, 1);
    for (unsigned i = 0; i < changes_per_cycle; ++i) w.set(all[random() % signals], random());
  }
}

}  // namespace cde::testing
