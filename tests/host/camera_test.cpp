// SPDX-License-Identifier: Apache-2.0
#include "cde/image/camera.hpp"

#include <cmath>
#include <limits>
#include <ostream>

#include "cde/geometry/primitives.hpp"
#include "testing.hpp"

namespace cde {
namespace {

using testing::expect_error;

TEST(PrimitivesTest, BadPrimitives_AreNamed) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  constexpr float kInf = std::numeric_limits<float>::infinity();
  const Ray good{{0, 0, 0}, {0, 0, 1}};
  EXPECT_FALSE(defect(good).has_value());
  EXPECT_FALSE(defect(Ray{{0, 0, 0}, {1e-45f, 0, -0x1p-34f}, -kInf, -kInf}).has_value());
  EXPECT_EQ(defect(Ray{{0, 0, 0}, {0, 0, -1e-38f}}),
            "largest component of direction is 9.99999935e-39, must be 2^-34 to 2^40");
  EXPECT_EQ(defect(Ray{{0, 2e12f, 0}, {0, 0, 1}}),
            "origin.y is 1.99999999e+12, must be at most 2^40 in size");
  EXPECT_EQ(defect(Ray{{0, 0, 0}, {0, 0, -0x1.8p40f}}),
            "direction.z is -1.64926744e+12, must be at most 2^40 in size");
  EXPECT_EQ(defect(Ray{{0, kNan, 0}, {0, 0, 1}}), "origin.y is nan");
  EXPECT_EQ(defect(Ray{{0, 0, 0}, {0, 0, -kInf}}), "direction.z is -inf");
  EXPECT_EQ(defect(Ray{{0, 0, 0}, {0, -0.0f, 0}}), "direction is zero");
  EXPECT_EQ(defect(Ray{{0, 0, 0}, {0, 0, 1}, kNan}), "tmin is nan");
  EXPECT_EQ(defect(Ray{{0, 0, 0}, {0, 0, 1}, 0, kNan}), "tmax is nan");
  EXPECT_FALSE(defect(Triangle{{0, 0, 0}, {0, 0, 0}, {0, 0, 0}}).has_value());
  EXPECT_EQ(defect(Triangle{{0, 0, 0}, {0, 0, 0}, {kInf, 0, 0}}), "v2.x is inf");
  expect_error(ErrorCode::kBadInput, "ray 7: direction is zero", [] {
    check(Ray{{0, 0, 0}, {0, 0, 0}}, "ray 7");
  });
}

TEST(CameraTest, Rays_RunRowByRowFromTheTop) {
  Camera camera{{0, 0, 10}, {0, 5, 10}};  // looks north
  camera.fov_degrees = 90.0f;
  const auto rays = camera.rays({4, 2});
  ASSERT_EQ(rays.size(), 8u);
  for (const Ray& ray : rays) {
    EXPECT_EQ(ray.o, camera.eye);
    EXPECT_NEAR(ray.d.norm(), 1.0f, 1e-6f);
    EXPECT_FALSE(defect(ray).has_value());
  }
  // Pixel centres at x = -1.5 -0.5 0.5 1.5 and z = 0.5 -0.5 on the plane y = 1.
  EXPECT_TRUE((rays[0].d / rays[0].d.y()).isApprox(Eigen::Vector3f(-1.5f, 1, 0.5f), 1e-6f));
  EXPECT_TRUE((rays[3].d / rays[3].d.y()).isApprox(Eigen::Vector3f(1.5f, 1, 0.5f), 1e-6f));
  EXPECT_TRUE((rays[6].d / rays[6].d.y()).isApprox(Eigen::Vector3f(0.5f, 1, -0.5f), 1e-6f));
}

TEST(CameraTest, StraightDownCamera_HasNorthUp) {
  const auto rays = Camera{{0, 0, 9}, {0, 0, 0}}.rays({1, 2});
  EXPECT_GT(rays[0].d.y(), 0.0f);
  EXPECT_LT(rays[1].d.y(), 0.0f);
}

struct Framing {
  const char* name;
  Eigen::Vector3f low, high;
  Resolution size;

  friend void PrintTo(const Framing& f, std::ostream* out) { *out << f.name; }
};

class CameraFor : public ::testing::TestWithParam<Framing> {};
INSTANTIATE_TEST_SUITE_P(
    Boxes, CameraFor,
    ::testing::Values(Framing{"terrain", {0, 0, 0}, {2910, 4460, 400}, {1280, 800}},
                      Framing{"portrait", {0, 0, 0}, {2910, 4460, 400}, {300, 900}},
                      Framing{"wide", {-50, -1, -1}, {50, 1, 1}, {640, 480}},
                      Framing{"tiny", {1e-4f, 1e-4f, 1e-4f}, {2e-4f, 3e-4f, 2e-4f}, {640, 480}},
                      Framing{"huge", {-1e30f, -1e30f, 0}, {1e30f, 1e30f, 1e30f}, {640, 480}}),
    [](const auto& info) { return std::string(info.param.name); });

TEST_P(CameraFor, Box_FillsThePicture) {
  const auto& [name, low, high, size] = GetParam();
  const Eigen::AlignedBox3f box(low, high);
  const Camera camera = camera_for(box, size);
  const Eigen::Vector3d forward = (camera.target - camera.eye).cast<double>().normalized();
  const Eigen::Vector3d right = forward.cross(Eigen::Vector3d::UnitZ()).normalized();
  const Eigen::Vector3d up = right.cross(forward);
  const double half_y = std::tan(camera.fov_degrees * 3.14159265358979 / 360.0);
  const double half_x = half_y * size.width / size.height;
  double widest = 0.0, left = 1, right_most = -1;
  for (int i = 0; i < 8; ++i) {
    const Eigen::Vector3d c =
        (box.corner(static_cast<Eigen::AlignedBox3f::CornerType>(i)).cast<double>() -
         camera.eye.cast<double>());
    ASSERT_GT(c.dot(forward), 0.0);
    const double x = c.dot(right) / c.dot(forward) / half_x,
                 y = c.dot(up) / c.dot(forward) / half_y;
    widest = std::max({widest, std::fabs(x), std::fabs(y)});
    left = std::min(left, x);
    right_most = std::max(right_most, x);
  }
  EXPECT_LT(widest, 1.0);
  EXPECT_GT(widest, 0.9);
  EXPECT_NEAR(left, -right_most, 0.05) << "the view is not centred";
}

/// The camera centres the visible points, not their box: for example a long object along the box's
/// diagonal.
TEST(CameraTest, Points_AreCentred) {
  const std::vector<Eigen::Vector3f> points{{0, 0, 0}, {10, 0, 4}, {2, 9, 1}, {3, 2, 0}};
  const Resolution size{640, 480};
  const Camera camera = camera_for(points, size);
  const Eigen::Vector3d forward = (camera.target - camera.eye).cast<double>().normalized();
  const Eigen::Vector3d right = forward.cross(Eigen::Vector3d::UnitZ()).normalized();
  const Eigen::Vector3d up = right.cross(forward);
  Eigen::AlignedBox2d seen;
  for (const Eigen::Vector3f& point : points) {
    const Eigen::Vector3d c = (point - camera.eye).cast<double>();
    ASSERT_GT(c.dot(forward), 0.0);
    seen.extend(Eigen::Vector2d(c.dot(right) / c.dot(forward), c.dot(up) / c.dot(forward)));
  }
  const double half_y = std::tan(camera.fov_degrees * 3.14159265358979 / 360.0);
  EXPECT_NEAR(seen.center().x(), 0.0, 1e-3);
  EXPECT_NEAR(seen.center().y(), 0.0, 1e-3);
  const double fills = std::max(seen.max().x() / (half_y * 4 / 3), seen.max().y() / half_y);
  EXPECT_LT(fills, 1.0);
  EXPECT_GT(fills, 0.9);
}

TEST(CameraTest, Grid_LooksDown) {
  const auto rays = grid_rays({Eigen::Vector3f(0, 0, 0), Eigen::Vector3f(8, 4, 1)}, {4, 2});
  ASSERT_EQ(rays.size(), 8u);
  EXPECT_EQ(rays[0].o, Eigen::Vector3f(1, 3, 9));
  EXPECT_EQ(rays[3].o, Eigen::Vector3f(7, 3, 9));
  EXPECT_EQ(rays[4].o, Eigen::Vector3f(1, 1, 9));
  for (const Ray& ray : rays) EXPECT_EQ(ray.d, Eigen::Vector3f(0, 0, -1));
}

TEST(CameraTest, CameraTexts_AreParsedOrRefused) {
  const Camera camera = parse_camera("1,2,3, 4,5,6 , 30");
  EXPECT_EQ(camera.target, Eigen::Vector3f(4, 5, 6));
  EXPECT_EQ(camera.fov_degrees, 30.0f);
  EXPECT_EQ(parse_camera("1,2,3,4,5,6").fov_degrees, 40.0f);
  for (const char* bad : {"", "1,2,3", "1,2,3,4,5,6,7,8", "1,2,3,4,5,6,7,", "1,2,3,1,2,3",
                          "1,2,3,4,5,6,0", "1,2,3,4,5,6,180", "1,2,3,4,5,6,-1", "1,2,3,4,5,nan",
                          "1,2,inf,4,5,6", "1,2,3,4,5,6,", "a,2,3,4,5,6"}) {
    expect_error(ErrorCode::kUsage, "camera", [&] { (void)parse_camera(bad); });
  }
  expect_error(ErrorCode::kUsage, "of 180 degrees, must be above 0 and below 180",
               [] { (void)parse_camera("1,2,3,4,5,6,180"); });
  EXPECT_EQ(parse_resolution("640x480").width, 640u);
  for (const char* bad :
       {"", "640", "x", "640x", "x480", "0x4", "4x0", "-4x4", "99999x4", "4x4x4", "4 x4"}) {
    expect_error(ErrorCode::kUsage, "", [&] { (void)parse_resolution(bad); });
  }
  expect_error(ErrorCode::kUsage, "nothing to look at", [] {
    (void)camera_for(Eigen::AlignedBox3f(), {4, 4});
  });
}

}  // namespace
}  // namespace cde
