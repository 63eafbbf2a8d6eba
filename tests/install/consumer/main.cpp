// SPDX-License-Identifier: Apache-2.0
// Casts two rays at a terrain on a simulated card and compares the answers with the reference. With
// an argument, the card's model must lie in that folder.
#include <cde/card/board.hpp>
#include <cde/mesh/terrain.hpp>
#include <cde/reference/reference.hpp>
#include <cde/support/error.hpp>
#include <cstdio>
#include <vector>

int main(int argc, char** argv) try {
  const cde::Mesh mesh = cde::make_terrain({.quads_x = 40, .quads_y = 30});
  cde::Board board = cde::Board::open({.lanes = 16});  // initializeDevice
  board.upload(mesh);                                  // secondaryUpload
  if (argc > 1 && !board.model_path().string().starts_with(argv[1])) {
    std::fprintf(stderr, "%s is not in %s\n", board.model_path().c_str(), argv[1]);
    return 3;
  }

  const std::vector<cde::Ray> rays = {{.o = {200, 150, 1000}, .d = {0, 0, -1}},
                                      {.o = {200, 150, 1000}, .d = {0, 0, 1}}};
  const std::vector<cde::Record> records = board.cast(rays);  // registers, invokeCDE, downloadSRAM
  for (const cde::Record& r : records) {
    if (r.bad) {
      std::printf("ray %u is outside the contract\n", r.primary);
    } else if (r.f) {
      std::printf("ray %u hits triangle %u at t = %g, height %g\n", r.primary, r.index, r.t,
                  r.cp.z());
    } else {
      std::printf("ray %u hits nothing\n", r.primary);
    }
  }
  const std::vector<cde::Record> expected = cde::reference::cast(rays, mesh);
  for (std::size_t i = 0; i < records.size(); ++i) {
    if (!same_bits(records[i], expected[i])) return 1;
  }
  return records[0].f && !records[1].f ? 0 : 1;
} catch (const cde::Error& e) {
  std::fprintf(stderr, "%s\n", e.what());
  return 2;
}
