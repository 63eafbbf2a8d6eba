// SPDX-License-Identifier: Apache-2.0
#include "cde/query/counters.hpp"

#include <algorithm>

namespace cde {

ModelledTime& ModelledTime::operator+=(const ModelledTime& other) {
  load += other.load;
  engine += other.engine;
  write_back += other.write_back;
  download += other.download;
  registers += other.registers;
  return *this;
}

Counters& Counters::operator+=(const Counters& other) {
  cycles += other.cycles;
  writeback += other.writeback;
  rows += other.rows;
  stalls += other.stalls;
  bubbles += other.bubbles;
  uncertain += other.uncertain;
  bad_primaries += other.bad_primaries;
  bad_secondaries += other.bad_secondaries;
  corrected_words += other.corrected_words;
  secondaries += other.secondaries;
  pairs += other.pairs;
  nodes += other.nodes;
  leaves += other.leaves;
  cached_nodes += other.cached_nodes;
  fetched_nodes += other.fetched_nodes;
  deepest = std::max(deepest, other.deepest);
  records += other.records;
  upload_cycles += other.upload_cycles;
  total_cycles += other.total_cycles;
  time += other.time;
  return *this;
}

}  // namespace cde
