// SPDX-License-Identifier: Apache-2.0
// Rays from NumPy arrays, .npy and .npz.
#include <cmath>
#include <limits>
#include <random>
#include <sstream>

#include "arrays.hpp"
#include "cde/io/rays.hpp"
#include "cde/support/error.hpp"
#include "testing.hpp"

namespace cde::ray_arrays {
namespace {

using testing::bytes;
using testing::expect_error;
using testing::Folder;
using testing::npy;
using testing::npz;

RayList read(const std::string& file) {
  std::istringstream in(file);
  return read_rays(in, "r.npy");
}

using Axes = std::vector<std::uint64_t>;

/// Expects two rays: 1, 2, ..., 6 and 7, 8, ..., 12.
void expect_two(const RayList& list, const Axes& shape = {2}) {
  EXPECT_EQ(list.shape, shape);
  ASSERT_EQ(list.rays.size(), 2u);
  EXPECT_EQ(list.rays[0].o, Eigen::Vector3f(1, 2, 3));
  EXPECT_EQ(list.rays[0].d, Eigen::Vector3f(4, 5, 6));
  EXPECT_EQ(list.rays[1].o, Eigen::Vector3f(7, 8, 9));
  EXPECT_EQ(list.rays[1].d, Eigen::Vector3f(10, 11, 12));
  EXPECT_EQ(list.rays[1].tmin, 0.0f);
  EXPECT_EQ(list.rays[1].tmax, std::numeric_limits<float>::infinity());
}

template <class T>
std::vector<T> twelve() {
  std::vector<T> values;
  for (int i = 1; i <= 12; ++i) values.push_back(static_cast<T>(i));
  return values;
}

TEST(RayArrays, EveryTypeOfNumber_ReadsTheSame) {
  for (const bool big : {false, true}) {
    const std::string order = big ? ">" : "<";
    const auto two = [&](const std::string& type, const std::string& data) {
      SCOPED_TRACE(order + type);
      expect_two(read(npy("'" + order + type + "'", "(2, 6)", data)));
    };
    two("f4", bytes(twelve<float>(), big));
    two("f8", bytes(twelve<double>(), big));
    two("i1", bytes(twelve<std::int8_t>(), big));
    two("u1", bytes(twelve<std::uint8_t>(), big));
    two("i2", bytes(twelve<std::int16_t>(), big));
    two("u2", bytes(twelve<std::uint16_t>(), big));
    two("i4", bytes(twelve<std::int32_t>(), big));
    two("u4", bytes(twelve<std::uint32_t>(), big));
    two("i8", bytes(twelve<std::int64_t>(), big));
    two("u8", bytes(twelve<std::uint64_t>(), big));
    const std::vector<std::uint16_t> halves = {0x3c00, 0x4000, 0x4200, 0x4400, 0x4500, 0x4600,
                                               0x4700, 0x4800, 0x4880, 0x4900, 0x4980, 0x4a00};
    two("f2", bytes(halves, big));
  }
  const auto one = read(npy("'|i1'", "(1, 6)", bytes<std::int8_t>({-1, -2, -128, 0, 0, 127})));
  EXPECT_EQ(one.rays[0].o, Eigen::Vector3f(-1, -2, -128));
  EXPECT_EQ(read(npy("'<i8'", "(1, 6)", bytes<std::int64_t>({-5, 0, 0, 0, 0, 1}))).rays[0].o.x(),
            -5.0f);
  const auto special =
      read(npy("'<f2'", "(1, 8)",
               bytes<std::uint16_t>({0x0001, 0x8000, 0x3555, 0, 0, 0xbc00, 0xfc00, 0x7c00})));
  EXPECT_EQ(special.rays[0].o.x(), 0x1p-24f);
  EXPECT_TRUE(std::signbit(special.rays[0].o.y()));
  EXPECT_EQ(special.rays[0].tmin, -std::numeric_limits<float>::infinity());
}

TEST(RayArrays, LeadingAxes_StayInCOrder) {
  const std::string c = bytes(twelve<float>());
  expect_two(read(npy("'<f4'", "(2, 6)", c)));
  expect_two(read(npy("'<f4'", "(1, 2, 6)", c)), {1, 2});
  expect_two(read(npy("'<f4'", "(2, 1, 1, 6)", c)), {2, 1, 1});
  expect_two(read(npy("'<f4'", "(2L, 6L)", c)));
  const RayList lone = read(npy("'<f4'", "(6,)", c.substr(0, 24)));
  EXPECT_EQ(lone.shape, Axes{});
  ASSERT_EQ(lone.rays.size(), 1u);
  EXPECT_EQ(lone.rays[0].d, Eigen::Vector3f(4, 5, 6));
  const RayList none = read(npy("'<f4'", "(3, 0, 6)", ""));
  EXPECT_EQ(none.shape, (Axes{3, 0}));
  EXPECT_TRUE(none.rays.empty());
}

TEST(RayArrays, FortranOrder_ReadsTheSameRays) {
  expect_two(
      read(npy("'<f4'", "(2, 6)", bytes<float>({1, 7, 2, 8, 3, 9, 4, 10, 5, 11, 6, 12}), "True")));
  // (2, 3, 7): element (i, j, k) is at i + 2 j + 6 k.
  std::vector<double> values(42);
  for (int i = 0; i < 2; ++i)
    for (int j = 0; j < 3; ++j)
      for (int k = 0; k < 7; ++k) values[i + 2 * j + 6 * k] = 100 * (i + 1) + 10 * j + k;
  const RayList list = read(npy("'<f8'", "(2, 3, 7)", bytes(values), "True"));
  EXPECT_EQ(list.shape, (Axes{2, 3}));
  ASSERT_EQ(list.rays.size(), 6u);
  for (std::size_t r = 0; r < 6; ++r) {
    const float first = 100.0f * (r / 3 + 1) + 10.0f * (r % 3);
    EXPECT_EQ(list.rays[r].o, Eigen::Vector3f(first, first + 1, first + 2)) << r;
    EXPECT_EQ(list.rays[r].tmin, first + 6) << r;
  }
}

TEST(RayArrays, Structures_NameTheirFields) {
  const std::string c = bytes(twelve<float>());
  expect_two(read(npy("[('o', '<f4', (3,)), ('d', '<f4', (3,))]", "(2,)", c)));
  expect_two(read(npy("[('o', '<f4', 3), ('d', '<f4', (1, 3))]", "(2, 1)", c)), {2, 1});
  // The form of pandas.DataFrame.to_records(index=False).
  expect_two(
      read(npy("[('ox', '<f4'), ('oy', '<f4'), ('oz', '<f4'), ('dx', '<f4'), ('dy', '<f4'), "
               "('dz', '<f4')]",
               "(2,)", c)));
  const std::string mixed = bytes<float>({9}) + std::string(4, '\x7f') +
                            bytes<double>({4, 5, 6}, true) + bytes<std::int16_t>({1, 2, 3}) +
                            bytes<float>({-1});
  const RayList list = read(
      npy("[('tmax', '<f4'), ('', '|V4'), ('d', '>f8', (3,)), ('o', '<i2', (3,)), ('tmin', '<f4')]",
          "()", mixed));
  EXPECT_EQ(list.shape, Axes{});
  ASSERT_EQ(list.rays.size(), 1u);
  EXPECT_EQ(list.rays[0].o, Eigen::Vector3f(1, 2, 3));
  EXPECT_EQ(list.rays[0].d, Eigen::Vector3f(4, 5, 6));
  EXPECT_EQ(list.rays[0].tmin, -1.0f);
  EXPECT_EQ(list.rays[0].tmax, 9.0f);
  // (2, 2) in Fortran order.
  const std::string type = "[('o', '<f4', (3,)), ('d', '<f4', (3,))]";
  const auto ray = [](float x) { return bytes<float>({x, 0, 0, 0, 0, 1}); };
  const RayList fortran = read(npy(type, "(2, 2)", ray(0) + ray(2) + ray(1) + ray(3), "True"));
  for (std::size_t r = 0; r < 4; ++r) EXPECT_EQ(fortran.rays[r].o.x(), static_cast<float>(r));
}

TEST(RayArrays, Archives_HoldOneArray) {
  const std::string array = npy("'<f4'", "(2, 6)", bytes(twelve<float>()), "False", 2);
  expect_two(read(npz({{"arr_0.npy", array}})));
  expect_two(read(npz({{"rays.npy", array}}, true)));
  expect_error(ErrorCode::kFile,
               "r.npy: has 2 files, 'o.npy', 'd.npy'; expected an .npz file with one array: rays "
               "are (..., 6)",
               [&] {
                 (void)read(npz({{"o.npy", array}, {"d.npy", array}}));
               });
  expect_error(ErrorCode::kFile, "r.npy: has no array", [&] { (void)read(npz({})); });
  expect_error(ErrorCode::kFile, "'a.txt' in it is not an array (.npy)", [&] {
    (void)read(npz({{"a.txt", "1,2,3"}}));
  });
  std::string damaged = npz({{"arr_0.npy", array}});
  damaged[200] ^= 1;
  expect_error(ErrorCode::kFile, "its checksum differs", [&] { (void)read(damaged); });
  std::string bomb = npz({{"arr_0.npy", array}}, true);
  const std::size_t entry = bomb.find("PK\x01\x02");
  bomb.replace(entry + 24, 4, testing::word(0xfffffff0, 4));
  expect_error(ErrorCode::kFile, "claims to be larger than it is", [&] { (void)read(bomb); });
  std::string noise(1 << 20, '\0');
  std::mt19937 random(1);
  for (char& c : noise) c = static_cast<char>(random());
  std::string large = npz({{"arr_0.npy", noise}}, true);
  large.replace(large.find("PK\x01\x02") + 24, 4, testing::word(700u << 20, 4));
  expect_error(ErrorCode::kFile, "over 64 times its packed size", [&] { (void)read(large); });
}

TEST(RayArrays, FirstBytes_SayWhatAFileIs) {
  const Folder folder;
  const std::string array = npy("'<f4'", "(2, 6)", bytes(twelve<float>()));
  expect_two(read_rays(folder.write("r.dat", array)));
  expect_two(read_rays(folder.write("r.npz", npz({{"arr_0.npy", array}}))));
  const std::string text = "1 2 3 4 5 6\n7 8 9 10 11 12\n";
  expect_two(read_rays(folder.write("r.txt", text)));
  expect_error(ErrorCode::kFile, "t.npy: is not a NumPy array (.npy)",
               [&] { (void)read_rays(folder.write("t.npy", text)); });
  expect_error(ErrorCode::kFile, "none.npy: cannot be opened",
               [&] { (void)read_rays(folder / "none.npy"); });
}

struct BadArray {
  const char* name;
  std::string file;
  const char* message;
  ErrorCode code = ErrorCode::kFile;

  friend void PrintTo(const BadArray& b, std::ostream* out) { *out << b.name; }
};

class BadRayArrays : public ::testing::TestWithParam<BadArray> {};
INSTANTIATE_TEST_SUITE_P(
    Files, BadRayArrays,
    ::testing::Values(
        BadArray{"magic", "\x93NUMPX", "is not a NumPy array"},
        BadArray{"version", npy("'<f4'", "(1, 6)", std::string(24, '\0'), "False", 4),
                 "NumPy format 4.0, expected 1.0 to 3.0"},
        BadArray{"cut_header", npy("'<f4'", "(1, 6)", "").substr(0, 40), "truncated in its header"},
        BadArray{"no_python", std::string("\x93NUMPY\x01\x00\x04\x00(1,}", 14),
                 "not a Python dictionary"},
        BadArray{"deep", std::string("\x93NUMPY\x01\x00\x28\x00", 10) + std::string(40, '('),
                 "not a Python dictionary"},
        BadArray{"complex", npy("'<c16'", "(1, 6)", std::string(96, '\0')),
                 "its numbers are '<c16'; expected floats of 2, 4 or 8 bytes"},
        BadArray{"object", npy("'|O'", "(1, 6)", std::string(48, '\0')), "its numbers are '|O'"},
        BadArray{"bool", npy("'|b1'", "(1, 6)", std::string(6, '\0')), "its numbers are '|b1'"},
        BadArray{"long_double", npy("'<f16'", "(1, 6)", std::string(96, '\0')), "'<f16'"},
        BadArray{"five", npy("'<f4'", "(1, 5)", std::string(20, '\0')),
                 "its shape is (1, 5); rays are (..., 6), (..., 7) or (..., 8) numbers, ox, oy"},
        BadArray{"turned", npy("'<f4'", "(6, 2)", std::string(48, '\0')), "its shape is (6, 2)"},
        BadArray{"scalar", npy("'<f4'", "()", std::string(4, '\0')), "its shape is ()"},
        BadArray{"short_data", npy("'<f4'", "(2, 6)", std::string(24, '\0')),
                 "has 24 bytes behind its header; its shape (2, 6) takes 48"},
        BadArray{"two_arrays", npy("'<f4'", "(1, 6)", std::string(40, '\0')),
                 "has 40 bytes behind"},
        BadArray{"huge", npy("'<f4'", "(9999999999999999, 6)", std::string(24, '\0')),
                 "claims an impossible size"},
        BadArray{"longer_than_words", npy("'<f4'", "(99999999999999999999999, 6)", ""),
                 "shape is not a tuple of numbers"},
        BadArray{"negative", npy("'<f4'", "(-1, 6)", ""), "not a Python dictionary"},
        BadArray{"unknown_field",
                 npy("[('index', '<i8'), ('o', '<f4', (3,)), ('d', '<f4', (3,))]", "(1,)",
                     std::string(32, '\0')),
                 "its field 'index' of 1 number is not expected; rays are"},
        BadArray{"short_field",
                 npy("[('o', '<f4', (2,)), ('d', '<f4', (3,))]", "(1,)", std::string(20, '\0')),
                 "its field 'o' of 2 numbers is not expected"},
        BadArray{"missing_field", npy("[('o', '<f4', (3,))]", "(1,)", std::string(12, '\0')),
                 "its fields lack dx"},
        BadArray{"field_twice",
                 npy("[('o', '<f4', (3,)), ('d', '<f4', (3,)), ('ox', '<f4')]", "(1,)",
                     std::string(28, '\0')),
                 "its fields have ox twice"},
        BadArray{"nested", npy("[('o', [('x', '<f4')])]", "(1,)", std::string(4, '\0')),
                 "its field 'o' is a structure; rays are"},
        BadArray{"titles", npy("[(('t', 'o'), '<f4', (3,))]", "(1,)", std::string(12, '\0')),
                 "titles"},
        BadArray{"empty_elements", npy("[('', '|V0')]", "(281474976710656,)", ""),
                 "its fields lack ox"},
        BadArray{"overflow", npy("'<f8'", "(1, 6)", bytes<double>({1e300, 0, 0, 0, 0, 1})),
                 "ray 0: 1e+300 overflows a float", ErrorCode::kBadInput},
        BadArray{"long_whole_number",
                 npy("'<i8'", "(1, 6)",
                     bytes<std::int64_t>({0, (std::int64_t{1} << 53) + 1, 0, 0, 0, 1})),
                 "ray 0: oy is a whole number of more than 53 bits", ErrorCode::kBadInput},
        BadArray{"nan", npy("'<f2'", "(1, 6)", bytes<std::uint16_t>({0x7e00, 0, 0, 0, 0, 0x3c00})),
                 "ray 0: ", ErrorCode::kBadInput},
        BadArray{"zero_direction", npy("'<f4'", "(1, 6)", std::string(24, '\0')),
                 "ray 0: direction is zero", ErrorCode::kBadInput}),
    [](const auto& info) { return std::string(info.param.name); });

TEST_P(BadRayArrays, BadArray_IsRefusedWithItsReason) {
  expect_error(GetParam().code, GetParam().message, [] { (void)read(GetParam().file); });
}

TEST(RayArrays, Damage_IsAnErrorOrValidRays) {
  constexpr std::uint32_t kSeed = 20261128;
  std::mt19937 random(kSeed);
  const std::string plain = npy("'<f4'", "(2, 6)", bytes(twelve<float>()));
  const std::vector<std::string> wholes = {
      plain, npy("[('o', '<f4', (3,)), ('d', '<f8', (3,))]", "(1, 1)", std::string(36, '\x40')),
      npz({{"arr_0.npy", plain}}), npz({{"arr_0.npy", plain}}, true)};
  int read_well = 0;
  for (int round = 0; round < 40000; ++round) {
    std::string file = wholes[round % wholes.size()];
    for (std::size_t i = 0; i < 1 + random() % 3; ++i)
      file[random() % file.size()] = static_cast<char>(random());
    if (random() % 8 == 0) file.resize(random() % file.size());
    try {
      for (const Ray& ray : read(file).rays) EXPECT_FALSE(defect(ray).has_value());
      ++read_well;
    } catch (const Error& e) {
      EXPECT_TRUE(std::string(e.what()).starts_with("r.npy:")) << e.what();
    }
  }
  std::printf("seed %u: %d of 40000 damaged arrays read\n", kSeed, read_well);
  EXPECT_GT(read_well, 100);
  EXPECT_LT(read_well, 39000);
}

}  // namespace
}  // namespace cde::ray_arrays
