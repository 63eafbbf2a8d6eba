// What a user's first program does with the installed library.
#include <cde/error.hpp>
#include <cde/image.hpp>
#include <cde/mesh.hpp>
#include <cde/terrain.hpp>
#include <cstdio>
#include <filesystem>

int main() try {
  const cde::Mesh mesh = cde::make_terrain({.quads_x = 40, .quads_y = 30});
  std::printf("%zu triangles\n", mesh.faces.size());
  if (mesh.faces.size() != 2400) return 1;

  cde::GreyImage heights{.size = {41, 31}, .pixels = {}};
  for (const auto& vertex : mesh.vertices) {
    heights.pixels.push_back(static_cast<std::uint16_t>(vertex.z() * 100));
  }
  cde::write_png(heights, "heights.png");
  if (std::filesystem::file_size("heights.png") < 1000) return 1;

  const cde::Mesh missing = cde::load_mesh("no-such-mesh.stl");
  return 1;
} catch (const cde::Error& e) {
  std::printf("%s\n", e.what());
  return e.code() == cde::ErrorCode::kFile ? 0 : 1;
}
