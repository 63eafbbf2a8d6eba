// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cstring>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <vector>

#include "cde/support/error.hpp"
#include "cde/support/json_text.hpp"
#include "mesh/readers.hpp"

// Checks the ranges in glTF 2.0, and counts triangles. The importer adds offsets and lengths
// without a check, so a negative offset would read memory before the buffer. It leaves out
// triangles whose corner numbers are out of range.
namespace cde::mesh_readers {
namespace {

using nlohmann::json;

std::string whole_file(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// The JSON text of a .gltf, or of the first chunk of a .glb.
std::string_view json_text(std::string_view bytes) {
  constexpr std::size_t kHeader = 20;
  if (!bytes.starts_with("glTF")) return bytes;
  std::uint32_t length = 0;
  if (bytes.size() < kHeader) return {};
  std::memcpy(&length, bytes.data() + 12, sizeof(length));
  return bytes.substr(kHeader, length);
}

[[noreturn]] void fail(const std::string& where, const std::string& why) {
  throw Error(ErrorCode::kFile, where + " " + why);
}

/// The whole number `key` of `item`; `otherwise` if it is missing.
std::uint64_t number(const json& item, const char* key, const std::string& where,
                     std::optional<std::uint64_t> otherwise) {
  constexpr std::uint64_t kMost = std::uint64_t{1} << 53;
  const auto found = item.find(key);
  if (found == item.end()) {
    if (!otherwise) fail(where, fmt::format("has no {}", key));
    return *otherwise;
  }
  if (!found->is_number_unsigned() || found->get<std::uint64_t>() > kMost)
    fail(where, fmt::format("has {} {}; expected a whole number from 0 to 2^53", key,
                            found->dump(-1, ' ', true, json::error_handler_t::replace)));
  return found->get<std::uint64_t>();
}

/// Item `index` of the array `list`. Error kFile names the item that refers to it.
const json& item(const json& file, const char* list, std::uint64_t index, const std::string& from) {
  const auto found = file.find(list);
  const std::size_t count = found != file.end() && found->is_array() ? found->size() : 0;
  if (index >= count || !(*found)[index].is_object())
    fail(from, fmt::format("names {}[{}], which the file does not have", list, index));
  return (*found)[index];
}

void check_view(const json& file, const json& view, const std::string& where) {
  const std::uint64_t index = number(view, "buffer", where, {});
  const json& buffer = item(file, "buffers", index, where);
  const std::uint64_t offset = number(view, "byteOffset", where, 0),
                      length = number(view, "byteLength", where, {}),
                      bytes = number(buffer, "byteLength", fmt::format("buffers[{}]", index), {});
  number(view, "byteStride", where, 0);
  if (offset + length > bytes)
    fail(where, fmt::format("ends at byte {} of buffers[{}], which has {}", offset + length, index,
                            bytes));
}

/// Bytes of one element. Matrices have padding between columns and are not in meshes: 0.
std::uint64_t element_bytes(const json& accessor) {
  static const std::map<std::uint64_t, std::uint64_t> component{{5120, 1}, {5121, 1}, {5122, 2},
                                                                {5123, 2}, {5125, 4}, {5126, 4}};
  static const std::map<std::string, std::uint64_t> components{
      {"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}};
  const auto type = accessor.find("type"), kind = accessor.find("componentType");
  if (type == accessor.end() || !type->is_string() || kind == accessor.end() ||
      !kind->is_number_unsigned())
    return 0;
  const auto count = components.find(type->get<std::string>());
  const auto size = component.find(kind->get<std::uint64_t>());
  return count == components.end() || size == component.end() ? 0 : count->second * size->second;
}

void check_accessor(const json& file, const json& accessor, const std::string& where) {
  const std::uint64_t count = number(accessor, "count", where, {}),
                      offset = number(accessor, "byteOffset", where, 0),
                      element = element_bytes(accessor);
  if (!accessor.contains("bufferView")) return;
  const std::uint64_t index = number(accessor, "bufferView", where, {});
  const std::string name = fmt::format("bufferViews[{}]", index);
  const json& view = item(file, "bufferViews", index, where);
  if (element == 0 || count == 0) return;
  const std::uint64_t given = number(view, "byteStride", name, 0),
                      stride = given == 0 ? element : given,
                      bytes = number(view, "byteLength", name, {});
  const std::uint64_t available =
      offset > bytes || element > bytes - offset ? 0 : (bytes - offset - element) / stride + 1;
  if (count > available)
    fail(where, fmt::format("has {} elements of {} bytes from byte {}; {} holds {}", count, element,
                            offset, name, available));
}

/// Requires float positions: the importer reads whole numbers (KHR_mesh_quantization) as floats.
void check_positions(const json& file, const json& mesh, const std::string& where) {
  constexpr std::uint64_t kFloat = 5126;
  const auto primitives = mesh.find("primitives");
  if (primitives == mesh.end() || !primitives->is_array()) return;
  for (const json& primitive : *primitives) {
    if (!primitive.is_object() || !primitive.contains("attributes")) continue;
    const json& attributes = primitive["attributes"];
    if (!attributes.is_object() || !attributes.contains("POSITION")) continue;
    const std::uint64_t index = number(attributes, "POSITION", where, {});
    const json& accessor = item(file, "accessors", index, where);
    const std::string name = fmt::format("accessors[{}]", index);
    const std::uint64_t kind = number(accessor, "componentType", name, {});
    if (kind != kFloat || accessor.value("type", json()) != "VEC3")
      fail(name,
           fmt::format("has positions of componentType {} and type {}; expected {} (float) and "
                       "\"VEC3\"",
                       kind, accessor.value("type", json("none")).dump(), kFloat));
  }
}

/// Triangles of a primitive. Points and lines have none.
std::uint64_t triangles_of(const json& file, const json& primitive, const std::string& where) {
  constexpr std::uint64_t kTriangles = 4, kStrip = 5, kFan = 6;
  if (!primitive.is_object() || !primitive.contains("attributes")) return 0;
  const json& attributes = primitive["attributes"];
  if (!attributes.is_object() || !attributes.contains("POSITION")) return 0;
  const std::uint64_t mode = number(primitive, "mode", where, kTriangles),
                      index = primitive.contains("indices")
                                  ? number(primitive, "indices", where, {})
                                  : number(attributes, "POSITION", where, {}),
                      corners = number(item(file, "accessors", index, where), "count",
                                       fmt::format("accessors[{}]", index), {});
  if (mode == kStrip || mode == kFan) return corners < 3 ? 0 : corners - 2;
  if (mode != kTriangles) return 0;
  if (corners % 3 != 0)
    fail(where,
         fmt::format("has triangles of {} corners in all, which is no multiple of 3", corners));
  return corners / 3;
}

/// Whole numbers in the array `key` of an item. The importer refuses other entries.
std::vector<std::uint64_t> numbers(const json& item, const char* key) {
  std::vector<std::uint64_t> all;
  const auto found = item.find(key);
  if (found == item.end() || !found->is_array()) return all;
  for (const json& number : *found)
    if (number.is_number_unsigned()) all.push_back(number.get<std::uint64_t>());
  return all;
}

/// Triangles of the meshes that the file's scene reaches, each mesh counted once. The importer
/// reads no others.
std::uint64_t triangles_of_scene(const json& file) {
  const auto scenes = file.find("scenes");
  if (scenes == file.end() || !scenes->is_array() || scenes->empty()) return 0;
  const json& scene = item(file, "scenes", number(file, "scene", "the file", 0), "the file");
  std::vector<std::uint64_t> left = numbers(scene, "nodes");
  std::set<std::uint64_t> nodes, meshes;
  while (!left.empty()) {
    const std::uint64_t index = left.back();
    left.pop_back();
    if (!nodes.insert(index).second) continue;
    const json& node = item(file, "nodes", index, "a scene or node");
    if (node.contains("mesh"))
      meshes.insert(number(node, "mesh", fmt::format("nodes[{}]", index), {}));
    for (const std::uint64_t child : numbers(node, "children")) left.push_back(child);
  }
  std::uint64_t triangles = 0;
  for (const std::uint64_t index : meshes) {
    const json& mesh = item(file, "meshes", index, "a node");
    const auto primitives = mesh.find("primitives");
    if (primitives == mesh.end() || !primitives->is_array()) continue;
    for (const json& primitive : *primitives)
      triangles += triangles_of(file, primitive, fmt::format("meshes[{}]", index));
  }
  return triangles;
}

/// Whether the importer reads the geometry correctly without this extension.
bool is_harmless(const std::string& extension) {
  for (const char* const kind : {"KHR_materials_", "EXT_materials_", "KHR_texture_", "EXT_texture_",
                                 "MSFT_texture_", "KHR_lights_", "EXT_lights_", "KHR_xmp"})
    if (extension.starts_with(kind)) return true;
  return extension == "KHR_mesh_quantization" || extension == "KHR_draco_mesh_compression";
}

void check_extensions(const json& file) {
  const auto required = file.find("extensionsRequired");
  if (required == file.end() || !required->is_array()) return;
  for (const json& extension : *required)
    if (!extension.is_string() || !is_harmless(extension.get<std::string>()))
      fail("extensionsRequired",
           fmt::format("has {}, which is not read",
                       extension.dump(-1, ' ', true, json::error_handler_t::replace)));
}

template <typename Check>
void each(const json& file, const char* list, const Check& check) {
  const auto found = file.find(list);
  if (found == file.end() || !found->is_array()) return;  // glTF 1.0 has objects there
  for (std::size_t i = 0; i < found->size(); ++i) {
    const std::string where = fmt::format("{}[{}]", list, i);
    if (!(*found)[i].is_object()) fail(where, "is not an object");
    check((*found)[i], where);
  }
}

}  // namespace

std::optional<std::uint64_t> gltf_triangles(const std::filesystem::path& path) {
  const std::string bytes = whole_file(path);
  if (nested_deeper(json_text(bytes)))
    fail("JSON", fmt::format("is nested deeper than {} levels", kDeepestJson));
  const json file = json::parse(json_text(bytes), nullptr, false);
  if (!file.is_object()) return std::nullopt;
  check_extensions(file);
  each(file, "bufferViews",
       [&](const json& view, const std::string& where) { check_view(file, view, where); });
  each(file, "accessors", [&](const json& accessor, const std::string& where) {
    check_accessor(file, accessor, where);
  });
  each(file, "meshes",
       [&](const json& mesh, const std::string& where) { check_positions(file, mesh, where); });
  const auto meshes = file.find("meshes");
  if (meshes == file.end() || !meshes->is_array()) return std::nullopt;
  return triangles_of_scene(file);
}

}  // namespace cde::mesh_readers
