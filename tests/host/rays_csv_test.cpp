// SPDX-License-Identifier: Apache-2.0
#include "cde/io/rays_csv.hpp"

#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <limits>
#include <ostream>
#include <sstream>

#include "testing.hpp"

namespace cde {
namespace {

using testing::expect_error;
using testing::Folder;

std::vector<Ray> read(const std::string& text) {
  std::istringstream in(text);
  return read_rays_csv(in, "rays.csv");
}

constexpr float kInfinity = std::numeric_limits<float>::infinity();

TEST(RaysCsvTest, FieldsCommentsHeaderAndLineEnds_AreRead) {
  const auto rays = read(
      "\xef\xbb\xbfox, oy,oz,dx,dy,dz,tmin,tmax\r\n\r\n# comment\n1,2,3,0,0,-1\r\n  4 ,\t5,6 , "
      "1e2,-0,.5, 0.25\n7,8,9,0x1.8p3,-0X.1p-1,+1,-inf,INF\n0,0,0,1,0,0,5,2");
  ASSERT_EQ(rays.size(), 4u);
  EXPECT_EQ(rays[0].o, Eigen::Vector3f(1, 2, 3));
  EXPECT_EQ(rays[0].d, Eigen::Vector3f(0, 0, -1));
  EXPECT_EQ(rays[0].tmin, 0.0f);
  EXPECT_EQ(rays[0].tmax, kInfinity);
  EXPECT_EQ(rays[1].d, Eigen::Vector3f(100, 0, 0.5f));
  EXPECT_TRUE(std::signbit(rays[1].d.y()));
  EXPECT_EQ(rays[1].tmin, 0.25f);
  EXPECT_EQ(rays[1].tmax, kInfinity);
  EXPECT_EQ(rays[2].d, Eigen::Vector3f(12, -0x1p-5f, 1));
  EXPECT_EQ(rays[2].tmin, -kInfinity);
  EXPECT_GT(rays[3].tmin, rays[3].tmax) << "an empty interval is legal";
}

TEST(RaysCsvTest, Header_NamesTheColumns) {
  const Ray want = {{1, 2, 3}, {4, 5, 6}, 7, 8};
  const auto same = [&](const std::string& text) {
    const auto rays = read(text);
    return rays.size() == 1 && rays[0].o == want.o && rays[0].d == want.d &&
           rays[0].tmin == want.tmin && rays[0].tmax == want.tmax;
  };
  EXPECT_TRUE(same("ox,oy,oz,dx,dy,dz,tmin,tmax\n1,2,3,4,5,6,7,8\n"));
  EXPECT_TRUE(same("dx,dy,dz,ox,oy,oz,tmin,tmax\n4,5,6,1,2,3,7,8\n"));
  EXPECT_TRUE(same("tmax, dz,oz ,tmin,dy,oy,dx,ox\r\n8,6,3,7,5,2,4,1\r\n"));
  EXPECT_TRUE(
      same("\xef\xbb\xbf# rays\n\n\"tmin\",\"tmax\",\"ox\",\"oy\",\"oz\",\"dx\",\"dy\","
           "\"dz\"\n7,8,1,2,3,4,5,6"));

  const auto rays = read("dz,tmax,dy,dx,oz,oy,ox\n6,8,5,4,3,2,1\n");
  ASSERT_EQ(rays.size(), 1u);
  EXPECT_EQ(rays[0].d, want.d);
  EXPECT_EQ(rays[0].tmin, 0.0f);
  EXPECT_EQ(rays[0].tmax, 8.0f);
  EXPECT_EQ(read("dx,dy,dz,ox,oy,oz,tmin,tmax\n4,5,6,1,2,3,7")[0].tmin, 7.0f);
}

/// Expects the ray 0.5, 1, -2 towards 0, 0.25, -1 in the first line, and `count` rays.
void expect_rays(const std::string& text, std::size_t count = 1, float tmax = kInfinity) {
  SCOPED_TRACE(text);
  const auto rays = read(text);
  ASSERT_EQ(rays.size(), count);
  EXPECT_EQ(rays[0].o, Eigen::Vector3f(0.5f, 1, -2));
  EXPECT_EQ(rays[0].d, Eigen::Vector3f(0, 0.25f, -1));
  EXPECT_EQ(rays[0].tmin, 0.0f);
  EXPECT_EQ(rays[0].tmax, tmax);
}

TEST(RaysCsvTest, AnySeparator_ReadsTheSame) {
  expect_rays("0.5,1,-2,0,0.25,-1");
  expect_rays("0.5;1;-2;0;0.25;-1;0;7\n", 1, 7);
  expect_rays("0.5\t1\t-2\t0\t0.25\t-1\n");
  expect_rays("  0.5 1  -2 0 0.25 -1 \n");
  expect_rays("0.5 ;\t1; -2;0 ;0.25;-1\r1;1;1;1;1;1\r\n", 2);
  // The form of numpy.savetxt, with and without a header.
  const std::string savetxt =
      "5.000000000000000000e-01 1.000000000000000000e+00 -2.000000000000000000e+00 "
      "0.000000000000000000e+00 2.500000000000000000e-01 -1.000000000000000000e+00\n";
  expect_rays(savetxt + savetxt, 2);
  expect_rays("# ox oy oz dx dy dz\n" + savetxt);
  expect_rays("# dx dy dz ox oy oz\n0 .25 -1 .5 1 -2\n");
  expect_rays("# made by hand\n# dz,dy,dx,oz,oy,ox\n-1,.25,0,-2,1,.5\n");
  expect_rays("# ox oy\n# dz dx\n" + savetxt);
  expect_rays("# dz dy dx oz oy ox\nox oy oz dx dy dz\n" + savetxt);
}

TEST(RaysCsvTest, Quotes_BelongToFields) {
  expect_rays("\"0.5\",\"1\", \"-2\" ,0,\" 0.25\",\"-1\"");
  expect_rays("\"ox\" \"oy\" oz dx dy dz\n\"0.5\" 1 -2 \"0\" 0.25 -1\n");
  expect_rays("\"0,5\";1;-2;0;\"0,25\";-1");
  const auto bad = [](const std::string& text, const std::string& message) {
    SCOPED_TRACE(text);
    expect_error(ErrorCode::kFile, message, [&] { (void)read(text); });
  };
  bad("\"0.5,1,-2,0,0.25,-1\n", "rays.csv:1:1: a quote is not closed");
  bad("1,\"2\"3,4,5,6,7\n", "rays.csv:1:6: text after a closing quote; commas separate");
  bad("1,\"2\"\"\",4,5,6,7\n", "rays.csv:1:6: text after a closing quote");
  bad("1 \"2\"3 4 5 6 7\n", "rays.csv:1:6: text after a closing quote; blanks separate");
  bad("\"1,5\",2,3,4,5,6",
      "rays.csv:1:1: ox: '1,5' is not a number; a decimal comma is read where semicolons separate");
}

TEST(RaysCsvTest, DecimalCommas_NeedSemicolons) {
  expect_rays("0,5;1,0;-2,0;0;0,25;-1\n0,5;1;1;1;1;1\n", 2);
  const auto bad = [](const std::string& text, const std::string& message) {
    SCOPED_TRACE(text);
    expect_error(ErrorCode::kFile, message, [&] { (void)read(text); });
  };
  bad("0,5;1.0;-2;0;0;-1",
      "rays.csv:1:6: '1.0' has a decimal point, and a number before it a decimal");
  bad("0,5;1;-2;0;0;-1\n1.5;1;-2;0;0;-1", "rays.csv:2:2: '1.5' has a decimal point");
  bad("1,000,5;1;-2;0;0;-1", "rays.csv:1:1: ox: '1,000,5' is not a number");
  bad("1.000,5;1;-2;0;0;-1", "rays.csv:1:1: ox: '1.000,5' is not a number");
  bad("0,5\t1,0\t2\t0\t0\t-1", "oy: '5\\x091' is not a number; commas separate the fields");
  bad("0,5 1,0 2 0 0 -1", "rays.csv:1:3: oy: '5 1' is not a number; commas separate the fields");
}

TEST(RaysCsvTest, EmptyFields_ShiftNothing) {
  const auto bad = [](const std::string& text, const std::string& message) {
    SCOPED_TRACE(text);
    expect_error(ErrorCode::kFile, message, [&] { (void)read(text); });
  };
  bad("1\t2\t3\t4\t5\t6\t\t8", "rays.csv:1:13: tmin is empty");
  bad("1;2;3;4;5;6;;8", "rays.csv:1:13: tmin is empty");
  bad("\t1\t2\t3\t4\t5\t6", "rays.csv:1:1: ox is empty");
  bad("1\t2\t3\t4\t5\t6\t", "rays.csv:1:13: tmin is empty");
  bad("1\t2 3\t4\t5\t6\t7", "rays.csv:1:3: oy: '2 3' is not a number; tabs separate the fields");
}

/// The form of pandas.DataFrame.
TEST(RaysCsvTest, RowNumbers_AreIgnored) {
  expect_rays(",ox,oy,oz,dx,dy,dz\n0,.5,1,-2,0,.25,-1\n1,1,1,1,1,1,1\n", 2);
  expect_rays("Unnamed: 0,ox,oy,oz,dx,dy,dz\n1,.5,1,-2,0,.25,-1\n2,1,1,1,1,1,1\n", 2);
  expect_rays("\"\",\"ox\",\"oy\",\"oz\",\"dx\",\"dy\",\"dz\"\n\"0\",\"0.5\",1,-2,0,.25,-1\n");
  expect_rays("\tox\toy\toz\tdx\tdy\tdz\n0\t.5\t1\t-2\t0\t.25\t-1\n");
  expect_rays(";ox;oy;oz;dx;dy;dz\n0;0,5;1,0;-2,0;0,0;0,25;-1,0\n");
  expect_rays(" ox oy oz dx dy dz\n0 .5 1 -2 0 .25 -1\n1 1 1 1 1 1 1\n", 2);
  expect_rays("    ox   oy  oz dx  dy   dz\n0  .5  1  -2  0  .25 -1\n");
  expect_rays(" ox oy oz dx dy dz\n.5 1 -2 0 .25 -1\n");
  const auto bad = [](const std::string& text, const std::string& message) {
    SCOPED_TRACE(text);
    expect_error(ErrorCode::kFile, message, [&] { (void)read(",ox,oy,oz,dx,dy,dz\n" + text); });
  };
  bad("2,1,1,1,1,1,1\n",
      "rays.csv:2:1: row number 2, expected 0 or 1: the first column has no name");
  bad("0,1,1,1,1,1,1\n2,1,1,1,1,1,1\n", "rays.csv:3:1: row number 2, expected 1");
  bad("0.5,1,1,1,1,1,1\n", "rays.csv:2:1: '0.5' is not a row number");
  bad(",1,1,1,1,1,1\n", "rays.csv:2:1: '' is not a row number");
  bad("0,1,1,1,1,1\n", "too few fields: 5 of the 6 in the header");
  expect_error(ErrorCode::kFile, "rays.csv:1:4: unknown column ''",
               [] { (void)read("ox,,oy,oz,dx,dy,dz\n"); });
}

TEST(RaysCsvTest, OtherEncodings_AreNamed) {
  for (const std::string mark : {"\xff\xfe", "\xfe\xff"})
    expect_error(ErrorCode::kFile, "rays.csv: text in UTF-16 or UTF-32; save it as UTF-8",
                 [&] { (void)read(mark + std::string("1\0,\0", 4)); });
  expect_error(ErrorCode::kFile, "rays.csv: is a NumPy array", [] { (void)read("\x93NUMPY"); });
}

TEST(RaysCsvTest, EmptyText_IsAnEmptyList) {
  EXPECT_TRUE(read("").empty());
  EXPECT_TRUE(read("\n\n# only this").empty());
  EXPECT_TRUE(read("ox,oy,oz,dx,dy,dz\n").empty());
}

TEST(RaysCsvTest, Numbers_AreNearestFloats) {
  const auto ray = read("0.1,16777217,1e-46,1e-45,0x1.000001p0,1,3.4028235e38")[0];
  EXPECT_EQ(ray.o, Eigen::Vector3f(0.1f, 16777216.0f, 0.0f));
  EXPECT_EQ(ray.d.x(), std::numeric_limits<float>::denorm_min());
  EXPECT_EQ(ray.d.y(), 1.0f) << "a tie goes to even";
  EXPECT_EQ(ray.tmin, std::numeric_limits<float>::max());
}

struct BadRay {
  const char* name;
  const char* text;
  ErrorCode code;
  const char* message;

  friend void PrintTo(const BadRay& b, std::ostream* out) { *out << b.name; }
};

class BadRays : public ::testing::TestWithParam<BadRay> {};
INSTANTIATE_TEST_SUITE_P(
    Texts, BadRays,
    ::testing::Values(
        BadRay{"few", "1,2,3,4,5\n", ErrorCode::kFile, "rays.csv:1:10: too few fields: 5"},
        BadRay{"one", "#\n\n7", ErrorCode::kFile, "rays.csv:3:2: too few fields: 1"},
        BadRay{"many", "1,2,3,4,5,6,7,8,9\n", ErrorCode::kFile, "rays.csv:1:17: too many fields"},
        BadRay{"trailing_comma", "1,2,3,4,5,6,\n", ErrorCode::kFile,
               "rays.csv:1:13: tmin is empty"},
        BadRay{"empty_field", "1,2, ,4,5,6\n", ErrorCode::kFile, "rays.csv:1:5: oz is empty"},
        BadRay{"word", "ox,oy,oz,dx,dy,dz\r\n1,2,3,4,5,6\r\n1, 2,3x,4,5,6\r\n", ErrorCode::kFile,
               "rays.csv:3:6: oz: '3x' is not a number"},
        BadRay{"second_header", "ox,oy,oz,dx,dy,dz\nox,oy,oz,dx,dy,dz\n", ErrorCode::kFile,
               "rays.csv:2:1: ox: 'ox' is not a number"},
        BadRay{"unknown_column", "ox,oy,oz,dx,dy, dw\n1,2,3,4,5,6\n", ErrorCode::kFile,
               "rays.csv:1:17: unknown column 'dw'; expected ox, oy, oz, dx, dy, dz and"},
        BadRay{"unknown_first_column", "# c\nid,ox,oy,oz,dx,dy,dz\n", ErrorCode::kFile,
               "rays.csv:2:1: unknown column 'id'; expected"},
        BadRay{"empty_column", "ox,oy,oz,dx,dy,dz,\n", ErrorCode::kFile,
               "rays.csv:1:19: unknown column ''; expected"},
        BadRay{"column_in_capitals", "OX,OY,OZ,DX,DY,DZ\n", ErrorCode::kFile,
               "rays.csv:1:1: unknown column 'OX'; expected"},
        BadRay{"ninth_column", "ox,oy,oz,dx,dy,dz,tmin,tmax,w\n", ErrorCode::kFile,
               "rays.csv:1:29: unknown column 'w'; expected"},
        BadRay{"column_twice", "ox,oy,oz,dx,dy,ox\n1,2,3,4,5,6\n", ErrorCode::kFile,
               "rays.csv:1:16: column 'ox' appears twice; expected ox"},
        BadRay{"missing_column", "tmin,ox,oy,dx,dy,dz\n1,2,3,4,5,6\n", ErrorCode::kFile,
               "rays.csv:1:20: column 'oz' is missing; expected ox"},
        BadRay{"more_than_the_header", "ox,oy,oz,dx,dy,dz\n1,2,3,4,5,6,7\n", ErrorCode::kFile,
               "rays.csv:2:13: too many fields: the header names 6"},
        BadRay{"less_than_the_header", "tmin,dx,dy,dz,ox,oy,oz\n1,2,3,4,5,6\n", ErrorCode::kFile,
               "rays.csv:2:12: too few fields: 6 of the 7 in the header; oz is missing"},
        BadRay{"named_number", "dx,dy,dz,ox,oy,oz\n1,2,3,4,inf,6\n", ErrorCode::kBadInput,
               "rays.csv:2:9: oy is infinite"},
        BadRay{"named_direction", "ox,oy,oz,dz,dy,dx\n1,2,3,0,0,0\n", ErrorCode::kBadInput,
               "rays.csv:2:11: direction is zero"},
        BadRay{"two_signs", "1,--2,3,4,5,6", ErrorCode::kFile, "rays.csv:1:3: oy: '--2' is not"},
        BadRay{"sign_sign", "1,+-2,3,4,5,6", ErrorCode::kFile, "rays.csv:1:3: oy: '+-2' is not"},
        BadRay{"blank_between", "1,2 3,3,4,5,6", ErrorCode::kFile,
               "rays.csv:1:3: oy: '2 3' is not"},
        BadRay{"bare_0x", "1,0x,3,4,5,6", ErrorCode::kFile, "rays.csv:1:3: oy: '0x' is not"},
        BadRay{"overflow", "1,2,3,4,-1e39,6", ErrorCode::kFile,
               "rays.csv:1:9: dy: '-1e39' overflows a float"},
        BadRay{"nan", "1,2,nan,4,5,6", ErrorCode::kBadInput, "rays.csv:1:5: oz is nan"},
        BadRay{"nan_first", "nan,2,3,4,5,6", ErrorCode::kBadInput, "rays.csv:1:1: ox is nan"},
        BadRay{"nan_tmax", "1,2,3,4,5,6,0,nan", ErrorCode::kBadInput, "rays.csv:1:15: tmax is nan"},
        BadRay{"infinite_origin", "inf,2,3,4,5,6", ErrorCode::kBadInput,
               "rays.csv:1:1: ox is infinite"},
        BadRay{"infinite_direction", "1,2,3,4,-inf,6", ErrorCode::kBadInput,
               "rays.csv:1:9: dy is infinite"},
        BadRay{"zero_direction", "1,2,3, 0,-0,0", ErrorCode::kBadInput,
               "rays.csv:1:8: direction is zero"},
        BadRay{"underflow_to_zero", "1,2,3,1e-60,0,0", ErrorCode::kBadInput,
               "rays.csv:1:7: direction is zero"}),
    [](const auto& info) { return std::string(info.param.name); });

TEST_P(BadRays, BadLine_IsNamedWithColumn) {
  expect_error(GetParam().code, GetParam().message, [] { (void)read(GetParam().text); });
}

TEST(RaysCsvTest, RayText_IsParsedOrRefused) {
  const Ray ray = parse_ray(" 1,2,3, 0,0,1, 0,10 ");
  EXPECT_EQ(ray.tmax, 10.0f);
  expect_error(ErrorCode::kFile, "--ray:6: too few fields", [] { (void)parse_ray("1,2,3"); });
  expect_error(ErrorCode::kFile, "--ray:1: too few fields: 0", [] { (void)parse_ray(""); });
  EXPECT_EQ(parse_ray("1 2 3 0 0 1").o, Eigen::Vector3f(1, 2, 3));
  expect_error(ErrorCode::kBadInput, "--ray:7: direction is zero",
               [] { (void)parse_ray("1,2,3,0,0,0"); });
}

TEST(RaysCsvTest, MissingFilesAreErrors_AndAMillionLinesAreRead) {
  const Folder folder;
  expect_error(ErrorCode::kFile, "none.csv: cannot be opened",
               [&] { (void)read_rays_csv(folder / "none.csv"); });
  expect_error(ErrorCode::kFile, ": is a directory", [&] { (void)read_rays_csv(folder / "."); });
  std::string text;
  for (int i = 0; i < 1000000; ++i)
    text += fmt::format("{},{},{},0.25,-1.5e-3,{}\n", i * 0.37f, -i * 1.25f, 400.0f, i + 1);
  const auto path = folder.write("rays.csv", text);
  const auto start = std::chrono::steady_clock::now();
  const auto rays = read_rays_csv(path);
  std::printf("a million rays, %zu bytes: %.2f s\n", text.size(),
              std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  ASSERT_EQ(rays.size(), 1000000u);
  EXPECT_EQ(rays[999999].o, Eigen::Vector3f(999999 * 0.37f, -999999 * 1.25f, 400.0f));
}

}  // namespace
}  // namespace cde
