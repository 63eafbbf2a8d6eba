// SPDX-License-Identifier: Apache-2.0
// cde::mpi from C++, with three ranks. Each rank runs GoogleTest, so a failure on one rank ends the
// run with its status.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <functional>
#include <map>
#include <memory>
#include <numeric>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "cde/jobs/mpi_ranks.hpp"
#include "cde/mesh/terrain.hpp"
#include "cde/support/error.hpp"

namespace cde::mpi {
namespace {

/// A process can start and end MPI only once.
std::unique_ptr<Ranks> ranks;

struct Distributed {
  std::vector<std::uint64_t> numbers;  ///< as received
  std::map<unsigned, int> of_rank;
  std::string error;
};

struct Request {
  std::uint64_t chunks = 0;
  std::size_t bytes = 10;  ///< of an input, and of a result
  std::function<void(const Chunk&)> run = [](const Chunk&) {};
  std::function<std::optional<unsigned>(std::uint64_t)> owner = [](std::uint64_t) {
    return std::optional<unsigned>();
  };
  std::function<void(std::uint64_t)> done = [](std::uint64_t) {};
};

Distributed distribute(const Request& request) {
  Distributed distributed;
  std::uint64_t number = 0;
  Work work;
  work.next = [&]() -> std::optional<Chunk> {
    if (number == request.chunks) return std::nullopt;
    Chunk chunk{number, std::string(request.bytes, static_cast<char>('a' + number % 26)),
                request.owner(number)};
    ++number;
    return chunk;
  };
  work.more = [&] { return number < request.chunks; };
  work.run = [&](const Chunk& chunk) {
    request.run(chunk);
    return std::string(1, static_cast<char>(ranks->rank())) + chunk.input;
  };
  work.done = [&](std::uint64_t chunk, const std::string& result) {
    distributed.numbers.push_back(chunk);
    ++distributed.of_rank[static_cast<unsigned>(result.at(0))];
    EXPECT_EQ(result.substr(1), std::string(request.bytes, static_cast<char>('a' + chunk % 26)));
    request.done(chunk);
  };
  try {
    ranks->distribute(work);
  } catch (const Error& e) {
    distributed.error = e.what();
  }
  std::sort(distributed.numbers.begin(), distributed.numbers.end());
  return distributed;
}

std::vector<std::uint64_t> all(std::uint64_t count) {
  std::vector<std::uint64_t> numbers(count);
  std::iota(numbers.begin(), numbers.end(), 0u);
  return numbers;
}

TEST(Distribution, EveryChunk_RunsOnce) {
  for (const std::uint64_t chunks : {0, 1, 2, 100}) {
    for (const std::size_t bytes : {std::size_t{0}, std::size_t{10}, std::size_t{3} << 20}) {
      if (chunks * bytes > 100u << 20) continue;
      const Distributed distributed = distribute({.chunks = chunks, .bytes = bytes});
      EXPECT_EQ(distributed.error, "");
      const std::uint64_t here = ranks->rank() == 0 ? chunks : 0;
      EXPECT_EQ(distributed.numbers, all(here)) << chunks << " of " << bytes;
    }
  }
}

/// The overhead of distribution limits how many ranks one rank can feed. The test prints it without
/// a check.
TEST(Distribution, EmptyChunks_PrintTheOverhead) {
  constexpr std::uint64_t kChunks = 10'000;
  const auto start = std::chrono::steady_clock::now();
  const Distributed distributed = distribute({.chunks = kChunks});
  const std::chrono::duration<double, std::micro> took = std::chrono::steady_clock::now() - start;
  if (ranks->rank() != 0) return;
  EXPECT_EQ(distributed.numbers, all(kChunks));
  std::printf("%.1f us a chunk of nothing\n", took.count() / kChunks);
}

TEST(Distribution, SlowRank_GetsFewerChunks) {
  const Distributed distributed = distribute(
      {.chunks = 60, .run = [](const Chunk&) {
         std::this_thread::sleep_for(std::chrono::milliseconds(ranks->rank() == 1 ? 100 : 10));
       }});
  if (ranks->rank() != 0) return;
  EXPECT_EQ(distributed.numbers, all(60));
  for (const unsigned quick : {0u, 2u}) EXPECT_GT(distributed.of_rank.at(quick), 15) << quick;
  EXPECT_LT(distributed.of_rank.at(1), 12);
}

TEST(Distribution, OwnedChunks_GoToTheirRank) {
  const Distributed distributed =
      distribute({.chunks = 41,
                  .run = [](const Chunk& c) { EXPECT_EQ(c.number % 3, ranks->rank()); },
                  .owner = [](std::uint64_t c) { return std::optional<unsigned>(c % 3); }});
  EXPECT_EQ(distributed.numbers, all(ranks->rank() == 0 ? 41 : 0));
}

/// An error on any rank reaches all ranks, and they can continue with other work.
TEST(Distribution, Error_EndsTheWorkOnAllRanks) {
  for (const unsigned bad : {0u, 1u, 2u}) {
    const Distributed distributed = distribute(
        {.chunks = 1000, .bytes = 1 << 20, .run = [&](const Chunk& c) {
           if (c.number > 5 && ranks->rank() == bad)
             throw Error(ErrorCode::kMismatch, "chunk " + std::to_string(c.number) + " is bad");
           std::this_thread::sleep_for(std::chrono::milliseconds(2));
         }});
    const std::string where = ranks->place(bad) + ": chunk ";
    EXPECT_NE(distributed.error.find(where), std::string::npos) << distributed.error;
    EXPECT_EQ(distributed.error.starts_with("the run ended on rank 0: "), ranks->rank() != 0);
    EXPECT_LT(distributed.numbers.size(), 500u);
  }
  const Distributed taken = distribute({.chunks = 100, .done = [](std::uint64_t c) {
                                          if (c == 7) throw Error(ErrorCode::kFile, "disk is full");
                                        }});
  EXPECT_NE(taken.error.find("disk is full"), std::string::npos) << taken.error;
}

TEST(Collective, Broadcast_ReachesEveryRank) {
  const bool first = ranks->rank() == 0;
  const std::string bytes(5 << 20, 'x');
  EXPECT_EQ(ranks->broadcast(first ? bytes : "other"), bytes);
  EXPECT_EQ(ranks->broadcast(first ? "" : "other"), "");
  Mesh mesh;
  if (first) {
    mesh = make_terrain({.quads_x = 5, .quads_y = 4, .seed = 2});
    mesh.parts = {{"a", 0}, {"", 7}};
    mesh.dropped = 3;
  }
  ranks->broadcast(mesh);
  EXPECT_EQ(mesh.faces.size(), 40u);
  EXPECT_EQ(mesh.vertices.size(), 30u);
  ASSERT_EQ(mesh.parts.size(), 2u);
  EXPECT_EQ(mesh.parts[0].name, "a");
  EXPECT_EQ(mesh.parts[1].first_face, 7u);
  EXPECT_EQ(mesh.dropped, 3u);
  EXPECT_EQ(ranks->scatter([](unsigned rank) { return std::string(rank + 1, 'r'); }),
            std::string(ranks->rank() + 1, 'r'));
  const std::vector<std::string> names = ranks->all_of(std::to_string(ranks->rank()));
  EXPECT_EQ(names, (std::vector<std::string>{"0", "1", "2"}));
}

}  // namespace
}  // namespace cde::mpi

int main(int argc, char** argv) {
  cde::mpi::ranks = std::make_unique<cde::mpi::Ranks>();
  ::testing::InitGoogleTest(&argc, argv);
  const int status = RUN_ALL_TESTS();
  cde::mpi::ranks.reset();
  return status;
}
