// SPDX-License-Identifier: Apache-2.0
// A user's program that distributes work, as docs/guides/many_machines.md shows.
#include <cde/jobs/mpi_ranks.hpp>
#include <cstdio>

int main() {
  const cde::mpi::Ranks ranks;
  std::uint64_t next = 0, sum = 0;
  ranks.distribute(
      {.next = [&]() -> std::optional<cde::mpi::Chunk> {
         if (next == 10) return std::nullopt;
         return cde::mpi::Chunk{next++, "2"};
       },
       .more = [&] { return next < 10; },
       .run = [](const cde::mpi::Chunk& chunk) { return chunk.input + "1"; },
       .done = [&](std::uint64_t, const std::string& result) { sum += std::stoull(result); }});
  if (ranks.rank() == 0) std::printf("%llu\n", static_cast<unsigned long long>(sum));
  return ranks.rank() != 0 || sum == 210 ? 0 : 1;
}
