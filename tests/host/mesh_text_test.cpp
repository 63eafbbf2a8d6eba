// SPDX-License-Identifier: Apache-2.0
// OBJ, STL, PLY and OFF files as other programs write them.
#include <fmt/format.h>

#include <array>
#include <bit>
#include <cmath>

#include "cde/mesh/mesh.hpp"
#include "testing.hpp"

namespace cde {
namespace {

using testing::expect_error;
using testing::Folder;
using testing::small_mesh;

using Face = std::array<std::uint32_t, 3>;

/// Two triangles of a square, in each format with LF.
const std::string kObj =
    "# a square\nv 0 0 0 0.5 0.5 1\n\tv 1\t0 0\nv 1 1 0\n  v 0 1 0 \nvn 0 0 1\nf 1//1 2//1 3//1\nf "
    "1 3 4\n";
const std::string kStl =
    "solid a square\n facet normal 0 0 1\n  outer loop\n   vertex 0 0 0\n   vertex 1 0 0\n   "
    "vertex 1 1 0\n  endloop\n endfacet\n facet normal 0 0 1\n  outer loop\n   vertex 0 0 0\n   "
    "vertex 1 1 0\n   vertex 0 1 0\n  endloop\n endfacet\nendsolid a square\n";
const std::string kPlyHead =
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float "
    "z\nelement face 2\nproperty list uchar int vertex_indices\nend_header\n";
const std::string kPly = kPlyHead + "0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 2 3\n";

const std::string kOff =
    "OFF # a square\n\n4 2 0\n0 0 0\n 1\t0 0\n# corners\n1 1 0 255 0 0\n0 1 0\n3 0 1 2\n# last\n3  "
    "0 2 3 "
    "0.5 0.5 1\n";

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size())
    text.replace(at, from.size(), to);
  return text;
}

std::string upper(std::string text) {
  for (char& c : text) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return text;
}

void expect_square(const Mesh& mesh) {
  ASSERT_EQ(mesh.faces.size(), 2u);
  EXPECT_EQ(mesh.vertices.size(), 4u);
  const Triangle first = mesh.triangle(0), second = mesh.triangle(1);
  EXPECT_EQ(first.v0, Eigen::Vector3f(0, 0, 0));
  EXPECT_EQ(first.v1, Eigen::Vector3f(1, 0, 0));
  EXPECT_EQ(first.v2, Eigen::Vector3f(1, 1, 0));
  EXPECT_EQ(second.v2, Eigen::Vector3f(0, 1, 0));
}

void expect_square_without_warning(const Mesh& mesh) {
  expect_square(mesh);
  EXPECT_EQ(mesh.warnings, std::vector<std::string>{});
}

/// Odd lines end in `odd`, even lines in `even`.
std::string mixed(const std::string& text, const std::string& odd, const std::string& even) {
  std::string out;
  bool is_odd = true;
  for (const char c : text) {
    if (c != '\n') {
      out += c;
      continue;
    }
    out += is_odd ? odd : even;
    is_odd = !is_odd;
  }
  return out;
}

TEST(MeshText, LineEndsAndMarks_DoNotMatter) {
  const Folder folder;
  for (const auto& [file, text] :
       {std::pair{"a.obj", kObj}, {"a.stl", kStl}, {"a.ply", kPly}, {"a.off", kOff}}) {
    for (const char* mark : {"", "\xef\xbb\xbf"}) {
      for (const auto& [odd, even] : {std::pair{"\n", "\n"},
                                      {"\r\n", "\r\n"},
                                      {"\r", "\r"},
                                      {"\n", "\r\n"},
                                      {"\r", "\n"},
                                      {"\r\n", "\r"},
                                      {"\r\r\n", "\n"},
                                      {" \t\n", " \r\n"}}) {
        for (const bool complete : {true, false}) {
          SCOPED_TRACE(fmt::format("{} {} {:?} {:?} {}", file, *mark != 0, odd, even, complete));
          std::string bytes = mark + mixed(text, odd, even);
          if (!complete) bytes.resize(bytes.find_last_not_of(" \t\r\n") + 1);
          expect_square_without_warning(load_mesh(folder.write(file, bytes)));
        }
      }
    }
  }
}

TEST(MeshText, OffHeaders_AreReadAsTheyAreWritten) {
  const Folder folder;
  const std::string rest = kOff.substr(kOff.find("4 2 0") + 5);
  for (const char* header : {"OFF\n4 2 0", "OFF 4 2 0", "OFF4 2 0", "COFF\n4 2 0", "NOFF\n4 2 0",
                             "STCNOFF\n4 2", "CNOFF 4 2 7", "4 2 0", "# no header\n4 2"})
    expect_square_without_warning(load_mesh(folder.write("a.off", header + rest)));
}

/// Faces of 3 to 40 corners are cut into as many triangles as they have corners, less two.
TEST(MeshText, OffPolygons_KeepAllTriangles) {
  const Folder folder;
  std::string vertices, faces;
  std::size_t first = 0, triangles = 0;
  for (int corners = 3; corners <= 40; ++corners) {
    faces += std::to_string(corners);
    for (int k = 0; k < corners; ++k) {
      const double angle = 6.283185307179586 * k / corners;
      vertices += fmt::format("{} {} {}\n", std::cos(angle), std::sin(angle), corners);
      faces += fmt::format(" {}", first++);
    }
    faces += '\n';
    triangles += static_cast<std::size_t>(corners) - 2;
  }
  const Mesh mesh =
      load_mesh(folder.write("a.off", fmt::format("OFF {} 38 0\n{}{}", first, vertices, faces)));
  EXPECT_EQ(mesh.vertices.size(), first);
  EXPECT_EQ(mesh.faces.size(), triangles);
}

TEST(MeshText, Utf16_IsRefusedByName) {
  const Folder folder;
  for (const char* file : {"a.obj", "a.stl", "a.ply", "a.off"})
    for (const std::string& mark : {std::string("\xff\xfe"), std::string("\xfe\xff"),
                                    std::string("\xff\xfe\0\0", 4), std::string("\0\0\xfe\xff", 4)})
      expect_error(ErrorCode::kFile, std::string(file) + ": text in UTF-16 or UTF-32; save it as",
                   [&] { (void)load_mesh(folder.write(file, mark + "v\0 \0")); });
}

TEST(MeshText, ErrorLines_AreCountedForEveryLineEnd) {
  const Folder folder;
  for (const char* end : {"\n", "\r\n", "\r"})
    expect_error(ErrorCode::kFile, "a.obj:3: 'x' is not a number", [&] {
      (void)load_mesh(folder.write("a.obj", replaced("# a\n\nv 0 0 x\n", "\n", end)));
    });
}

TEST(MeshText, StlKeywords_AllowAnyCaseAndLeadingBlanks) {
  const Folder folder;
  for (const std::string& text :
       {upper(kStl), "  \n\t" + kStl, "\r\n\r\n \v\f" + upper(kStl),
        replaced(kStl, "solid", "Solid"), replaced(kStl, "a square", ""),
        replaced(kStl, "a square", "\xc3\xa9 binary"), replaced(kStl, " ", "\t"),
        replaced(kStl, "\n ", " ").replace(14, 1, "\n")}) {
    SCOPED_TRACE(text.substr(0, 60));
    expect_square_without_warning(load_mesh(folder.write("a.stl", text)));
  }
  // A name that is much longer than a buffer before the first facet.
  expect_square_without_warning(load_mesh(
      folder.write("a.stl", replaced(kStl, "solid a square", "solid " + std::string(3000, 'n')))));
}

std::string binary_stl(const std::string& head, std::uint32_t count) {
  const Folder folder;
  save_mesh(load_mesh(folder.write("a.obj", kObj)), folder / "a.stl");
  std::string bytes = testing::bytes_of(folder / "a.stl");
  bytes.replace(0, head.size(), head);
  for (int i = 0; i < 4; ++i) bytes[80 + i] = static_cast<char>(count >> (8 * i));
  return bytes;
}

TEST(MeshText, BinaryStlStartingWithSolid_IsReadAsBinary) {
  const Folder folder;
  for (const std::string& head : {std::string("solid"), std::string("SOLID part"),
                                  std::string("solid ") + std::string(74, 'x'),
                                  std::string("\xef\xbb\xbfsolid"), std::string(80, '\0')})
    expect_square_without_warning(load_mesh(folder.write("a.stl", binary_stl(head, 2))));
}

TEST(MeshText, BytesAfterTheLastFacet_AreAWarning) {
  const Folder folder;
  for (const char* head : {"", "solid x"}) {
    for (const std::size_t more : {1u, 37u, 50u, 5000u}) {
      const Mesh mesh =
          load_mesh(folder.write("a.stl", binary_stl(head, 2) + std::string(more, 'x')));
      expect_square(mesh);
      ASSERT_EQ(mesh.warnings.size(), 1u);
      EXPECT_TRUE(mesh.warnings[0].ends_with(
          fmt::format("a.stl: byte 184: {} bytes after the last of 2 facets are ignored", more)))
          << mesh.warnings[0];
    }
    expect_error(ErrorCode::kFile,
                 "a.stl: binary STL of 3 facets takes 234 bytes, the file has 184",
                 [&] { (void)load_mesh(folder.write("a.stl", binary_stl(head, 3))); });
    expect_error(
        ErrorCode::kFile,
        "binary STL of 0 facets takes 84 bytes, the file has 184: its writer did not set the count",
        [&] { (void)load_mesh(folder.write("a.stl", binary_stl(head, 0))); });
  }
}

TEST(MeshText, BytesAfterTheLastPlyRow_AreAWarning) {
  const Folder folder;
  const Mesh ascii = load_mesh(folder.write("a.ply", kPly + "\n 7 8\n"));
  expect_square(ascii);
  ASSERT_EQ(ascii.warnings.size(), 1u);
  EXPECT_TRUE(ascii.warnings[0].ends_with("a.ply:15: 6 bytes after the last row are ignored"))
      << ascii.warnings[0];
  const std::string whole = testing::bytes_of(small_mesh("icosphere.ply"));
  const Mesh mesh = load_mesh(folder.write("b.ply", whole + "xyz"));
  EXPECT_EQ(mesh.faces.size(), 1280u);
  ASSERT_EQ(mesh.warnings.size(), 1u);
  EXPECT_TRUE(mesh.warnings[0].ends_with(
      fmt::format("b.ply: byte {}: 3 bytes after the last row are ignored", whole.size())))
      << mesh.warnings[0];
}

TEST(MeshText, PlyValuesBeyondTheHeader_AreAWarningOrAnError) {
  const Folder folder;
  // MeshLab announces four scalars for the colour of a face and writes a list.
  const std::string lists =
      replaced(replaced(kPly, "end_header", "property uchar red\nproperty uchar alpha\nend_header"),
               "\n3 0", "\n3 0");
  const Mesh mesh =
      load_mesh(folder.write("a.ply", replaced(replaced(lists, "3 0 1 2", "3 0 1 2 9 1 1 1 1"),
                                               "3 0 2 3", "3 0 2 3 9 1 1")));
  expect_square(mesh);
  ASSERT_EQ(mesh.warnings.size(), 1u);
  EXPECT_TRUE(
      mesh.warnings[0].ends_with("a.ply:16: face row 0 has more values than the header announces, "
                                 "as has 1 other; they are ignored"))
      << mesh.warnings[0];
  const Mesh three = load_mesh(folder.write("a.ply", replaced(kPly, " 0\n", " 0 5\n")));
  ASSERT_EQ(three.warnings.size(), 1u);
  EXPECT_TRUE(three.warnings[0].ends_with("announces, as have 3 others; they are ignored"))
      << three.warnings[0];
  const Mesh vertices = load_mesh(folder.write("a.ply", replaced(kPly, "\n1 0 0", "\n1 0 0 5 5")));
  expect_square(vertices);
  ASSERT_EQ(vertices.warnings.size(), 1u);
  EXPECT_TRUE(vertices.warnings[0].ends_with(
      "a.ply:11: vertex row 1 has more values than the header announces; they are ignored"))
      << vertices.warnings[0];
  // If a value could shift the corners, the reader refuses the file.
  const std::string before = replaced(kPly, "property list", "property uchar red\nproperty list");
  expect_error(ErrorCode::kFile, "a.ply:15: face row 0 has too many values", [&] {
    (void)load_mesh(folder.write(
        "a.ply", replaced(replaced(before, "3 0 1 2", "1 3 0 1 2 7"), "3 0 2 3", "1 3 0 2 3 7")));
  });
}

TEST(MeshText, BlanksInAPlyHeader_AreAccepted) {
  const Folder folder;
  for (const std::string& text :
       {replaced(kPly, "ply\n", "ply \t\n"), replaced(kPly, "end_header", " end_header \t"),
        replaced(kPly, "property", "  property\t"), replaced(kPly, "format", "\n\nformat")})
    expect_square_without_warning(load_mesh(folder.write("a.ply", text)));
  expect_error(ErrorCode::kFile, "begins with the line 'ply'",
               [&] { (void)load_mesh(folder.write("a.ply", "\n" + kPly)); });
}

TEST(MeshText, PlyElementsAndProperties_ComeInAnyOrder) {
  const Folder folder;
  const std::string faces =
      "element face 2\nproperty uchar q\nproperty list uchar int vertex_index\nproperty list uchar "
      "float uv\n";
  const std::string vertices =
      "element vertex 4\nproperty uchar red\nproperty float nx\nproperty float z\nproperty float "
      "x\nproperty list uchar int l\nproperty double y\n";
  const std::string others =
      "element edge 1\nproperty int a\nelement nothing 0\nelement material 1\nproperty float k\n";
  const std::string face_rows = "7 3 0 1 2 0\n7 3 0 2 3 2 0.5 0.25\n";
  const std::string vertex_rows = "9 1 0 0 0 0\n9 1 0 1 2 5 5 0\n9 1 0 1 0 1\n9 1 0 0 1 4 1\n";
  const std::string head = "ply\nformat ascii 1.0\n";
  for (const std::string& text :
       {head + faces + vertices + "end_header\n" + face_rows + vertex_rows,
        head + vertices + others + faces + "end_header\n" + vertex_rows + "1\n0.5\n" + face_rows,
        head + others + faces + vertices + "end_header\n1\n0.5\n" + face_rows + vertex_rows})
    expect_square_without_warning(load_mesh(folder.write("a.ply", text)));
  // A concave polygon before its corners in the file is triangulated like one after them.
  const std::string corners = "0 0 0\n4 0 0\n4 4 0\n2 1 0\n";
  const std::string square = "element vertex 4\nproperty int x\nproperty int y\nproperty int z\n";
  const std::string polygon = "element face 1\nproperty list uchar int vertex_indices\n";
  const Mesh behind = load_mesh(
      folder.write("a.ply", head + square + polygon + "end_header\n" + corners + "4 0 1 2 3\n"));
  const Mesh before = load_mesh(
      folder.write("a.ply", head + polygon + square + "end_header\n4 0 1 2 3\n" + corners));
  EXPECT_EQ(before.faces, behind.faces);
  EXPECT_EQ(before.faces.size(), 2u);
  expect_error(ErrorCode::kFile, "face 0: vertex number 4 is out of range: 4 vertices", [&] {
    (void)load_mesh(
        folder.write("a.ply", head + polygon + square + "end_header\n4 0 1 2 4\n" + corners));
  });
}

TEST(MeshText, PlyTriangleStrips_AreRead) {
  const Folder folder;
  const Mesh mesh = load_mesh(folder.write(
      "a.ply",
      "ply\nformat ascii 1.0\nelement vertex 6\nproperty float x\nproperty float y\nproperty float "
      "z\nelement tristrips 1\nproperty list int int vertex_indices\nend_header\n0 0 0\n0 1 0\n1 0 "
      "0\n1 1 0\n2 0 0\n2 1 0\n11 0 1 2 3 4 -1 3 3 4 5 -1\n"));
  EXPECT_EQ(mesh.faces, (std::vector<Face>{{0, 1, 2}, {2, 1, 3}, {2, 3, 4}, {4, 3, 5}}));
}

/// Binary bodies that begin with the bytes of a line end.
TEST(MeshText, BinaryPly_FollowsEveryLineEnd) {
  const Folder folder;
  for (const char* end : {"\n", "\r\n", "\r"}) {
    for (const unsigned char first : {0x00, 0x0a, 0x0d, 0x20}) {
      const std::string header = replaced(
          "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\nproperty "
          "float y\nproperty float z\nelement face 1\nproperty list uchar int "
          "vertex_indices\nend_header\n",
          "\n", end);
      std::string body;
      const auto word = [&](std::uint32_t w) {
        for (int i = 0; i < 4; ++i) body.push_back(static_cast<char>(w >> (8 * i)));
      };
      for (std::uint32_t i = 0; i < 9; ++i) word(0x3f800000u + (i == 0 ? first : i));
      body.push_back(3);
      for (std::uint32_t i = 0; i < 3; ++i) word(i);
      SCOPED_TRACE(fmt::format("{:?} {:#x}", end, first));
      const Mesh mesh = load_mesh(folder.write("b.ply", header + body));
      EXPECT_EQ(mesh.warnings, std::vector<std::string>{});
      EXPECT_EQ(std::bit_cast<std::uint32_t>(mesh.triangle(0).v0.x()), 0x3f800000u + first);
      EXPECT_EQ(std::bit_cast<std::uint32_t>(mesh.triangle(0).v2.z()), 0x3f800008u);
    }
  }
}

}  // namespace
}  // namespace cde
