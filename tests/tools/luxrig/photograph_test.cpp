// Photographs of light: exposure, white balance, the camera that takes them, and why they are dark.
#include <gtest/gtest.h>
#include <jpeglib.h>

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <iterator>

#include "core/photometry/light_colour.h"
#include "core/rig/rig_file.h"
#include "core/tasks/rig_transport.h"
#include "core/tasks/scene_builder.h"
#include "tools/luxrig/render/dark_picture.h"
#include "tools/luxrig/room_view.h"
#include "tools/terminal/exposure.h"
#include "tools/terminal/picture_png.h"
#include "tools/terminal/png_canvas.h"

namespace luxrig {
namespace {

/// A textured square that fills `share` of the picture, alternating between two luminances, before a backdrop.
Picture square_before(double backdrop_cd_m2, double share, double dim_cd_m2, double bright_cd_m2,
                      const Vec3& colour_rgb = Vec3::Ones()) {
  Picture picture;
  picture.width_px = picture.height_px = 100;
  const double half_px = 50 * std::sqrt(share);
  for (int y = 0; y < 100; ++y)
    for (int x = 0; x < 100; ++x) {
      const bool inside = std::max(std::abs(x - 49.5), std::abs(y - 49.5)) < half_px;
      const double cd_m2 = !inside ? backdrop_cd_m2 : (x + y) % 2 == 0 ? dim_cd_m2 : bright_cd_m2;
      picture.luminance_cd_m2.push_back((cd_m2 * colour_rgb).cast<float>());
      picture.illuminance_lx.push_back(static_cast<float>(10 * cd_m2));
    }
  return picture;
}

TEST(Exposure, OfASmallObjectOnADarkBackdropKeepsItsHighlights) {
  for (const double share : {0.005, 0.04, 0.3}) {
    const double white_cd_m2 = metered_white_cd_m2(square_before(0.05, share, 40, 100));
    EXPECT_GE(white_cd_m2, 2.5 * 100) << share;
    EXPECT_LE(white_cd_m2, 10 * 100) << share;
  }
}

TEST(Exposure, OfAnEvenRoomUsesItsMeanLuminance) {
  EXPECT_NEAR(metered_white_cd_m2(square_before(20, 0.3, 18, 22)), 20 * 100 / 3.0, 20);
  EXPECT_GT(metered_white_cd_m2(square_before(0, 1, 0, 0)), 0) << "nothing shines";
}

TEST(Exposure, IsStopsOrALuminance) {
  EXPECT_DOUBLE_EQ(exposure_of("+1")->stops, 1);
  EXPECT_DOUBLE_EQ(exposure_of("-0.5")->stops, -0.5);
  EXPECT_DOUBLE_EQ(exposure_of("2 EV")->stops, 2);
  EXPECT_DOUBLE_EQ(*exposure_of("300cd/m2")->white_cd_m2, 300);
  for (const char* bad : {"", "bright", "30", "300lx", "-5cd/m2", "0cd/m2", "nan", "1e999"})
    EXPECT_FALSE(exposure_of(bad).has_value()) << bad;
}

TEST(WhiteBalanceOption, IsLampsDaylightOrATemperature) {
  EXPECT_TRUE(white_balance_of("lamps")->of_lamps);
  EXPECT_FALSE(white_balance_of("daylight")->of_lamps);
  EXPECT_DOUBLE_EQ(*white_balance_of("2700K")->cct_k, 2700);
  for (const char* bad : {"", "warm", "900", "2700F", "-3000"}) EXPECT_FALSE(white_balance_of(bad).has_value()) << bad;
}

Emitter lamp_of(double lumens, const Vec3& rgb) {
  Emitter lamp;
  lamp.intensity = make_isotropic(lumens);
  lamp.colour_rgb = rgb;
  return lamp;
}

TEST(WhiteOfLamps, IsTheBlackBodyNearestToTheLitLamps) {
  const std::vector<Emitter> lamps = {lamp_of(1000, rgb_of_cct(2700)), lamp_of(1000, rgb_of_cct(6000))};
  EXPECT_NEAR(*white_of_lamps(lamps, std::vector{1.0, 0.0}).cct_k, 2700, 20);
  EXPECT_NEAR(*white_of_lamps(lamps, std::vector{0.0, 0.5}).cct_k, 6000, 50);
  const double mixed_k = *white_of_lamps(lamps, std::vector{1.0, 1.0}).cct_k;
  EXPECT_GT(mixed_k, 3200);
  EXPECT_LT(mixed_k, 4500);
  EXPECT_FALSE(white_of_lamps(lamps, std::vector{0.0, 0.0}).cct_k.has_value());
  EXPECT_FALSE(white_of_lamps(std::vector{lamp_of(1000, Vec3::Ones())}, std::vector{1.0}).cct_k.has_value());
  const std::vector<Emitter> red = {lamp_of(1000, *with_luminance_1(Vec3(1, 0.02, 0.02)))};
  EXPECT_EQ(white_of_lamps(red, std::vector{1.0}).rgb, Vec3::Ones()) << "a red stage stays red";
}

/// Colour in the middle of a JPEG, 0…255.
Vec3 middle_of_jpeg(const std::filesystem::path& file) {
  std::FILE* in = std::fopen(file.c_str(), "rb");
  EXPECT_NE(in, nullptr);
  if (in == nullptr) return Vec3::Zero();
  jpeg_decompress_struct jpeg{};
  jpeg_error_mgr errors{};
  jpeg.err = jpeg_std_error(&errors);
  jpeg_create_decompress(&jpeg);
  jpeg_stdio_src(&jpeg, in);
  jpeg_read_header(&jpeg, TRUE);
  jpeg_start_decompress(&jpeg);
  std::vector<JSAMPLE> row(3 * jpeg.output_width);
  Vec3 colour = Vec3::Zero();
  while (jpeg.output_scanline < jpeg.output_height) {
    JSAMPROW rows[] = {row.data()};
    jpeg_read_scanlines(&jpeg, rows, 1);
    if (jpeg.output_scanline == jpeg.output_height / 2)
      for (int c = 0; c < 3; ++c) colour[c] = row[3 * (jpeg.output_width / 2) + static_cast<std::size_t>(c)];
  }
  jpeg_finish_decompress(&jpeg);
  jpeg_destroy_decompress(&jpeg);
  std::fclose(in);
  return colour;
}

TEST(Photograph, IsWrittenAsJpegWithTheRequestedWhiteBalance) {
  const auto file = std::filesystem::path(testing::TempDir()) / "luxrig_photograph.JPG";
  const Vec3 warm = rgb_of_cct(2700);
  const Picture picture = square_before(10, 1, 10, 10, warm);
  ASSERT_EQ(write_photograph(picture, "", {100, Vec3::Ones()}, file), "");
  const Vec3 orange = middle_of_jpeg(file);
  EXPECT_GT(orange.x(), 1.5 * orange.z());
  ASSERT_EQ(write_photograph(picture, "", {100, warm}, file), "");
  const Vec3 grey = middle_of_jpeg(file);
  EXPECT_NEAR(grey.x(), grey.y(), 3);
  EXPECT_NEAR(grey.z(), grey.y(), 3);
  // 10 of 100 cd/m² is 0.6 before the tone curve: 0.381 linear, 166 in sRGB.
  EXPECT_NEAR(grey.y(), 166, 3);
  ASSERT_EQ(write_photograph(picture, "", {10, warm}, file), "");
  EXPECT_NEAR(middle_of_jpeg(file).y(), 255, 1) << "the luminance of white";
  std::filesystem::remove(file);
  EXPECT_NE(write_photograph(picture, "", {}, "/nowhere/x.jpg"), "");
}

TEST(PictureNames, EndInPngOrJpg) {
  for (const char* good : {"a.png", "a.PNG", "a.jpg", "a.JPEG"}) EXPECT_TRUE(is_picture_name(good)) << good;
  for (const char* bad : {"a", "a.gif", "a.tiff", "png", "a.png.txt"}) EXPECT_FALSE(is_picture_name(bad)) << bad;
}

struct LitRoom {
  Rig rig;
  Scene scene;
};

/// Walls of 6 × 4 × 3 m, with the given contents.
LitRoom room_with(const std::string& further) {
  std::string text = "[rig]\nname = \"r\"\n[scene]\n";
  const auto slab = [&](const char* name, const char* at, const char* size) {
    text += std::string("[[scene.object]]\nname = \"") + name + "\"\nbox_m = " + size + "\nposition_m = " + at + "\n";
  };
  slab("floor", "[0, 0, -0.1]", "[6.4, 4.4, 0.1]");
  slab("ceiling", "[0, 0, 3]", "[6.4, 4.4, 0.1]");
  slab("west", "[-3.1, 0, 0]", "[0.2, 4.4, 3]");
  slab("east", "[3.1, 0, 0]", "[0.2, 4.4, 3]");
  slab("south", "[0, -2.1, 0]", "[6.4, 0.2, 3]");
  slab("north", "[0, 2.1, 0]", "[6.4, 0.2, 3]");
  const auto rig = parse_rig(text + further, "rig.toml", ".");
  EXPECT_TRUE(rig.has_value()) << (rig ? "" : rig.error().front().text());
  auto scene = build_scene(*rig);
  EXPECT_TRUE(scene.has_value());
  return {*rig, *scene};
}

constexpr const char* kSpotOnTheWall = R"(
[[luminaire]]
name = "l"
model = "spot"
beam_angle_deg = 20
field_angle_deg = 40
lumens = 1000
[[bus]]
name = "b"
driver = "sacn"
[[fixture]]
name = "lamp"
luminaire = "l"
position_m = [0, 0, 2.8]
aim_m = [2.9, 0, 1.2]
bus = "b"
universe = 1
address = 1
)";

TEST(AutomaticCamera, OfARigWithoutPointsStandsInTheRoomFacingItsLight) {
  const LitRoom room = room_with(kSpotOnTheWall);
  const RayScene rays(room.scene);
  const Camera camera = automatic_camera(rays, room.rig, {}, 320, 200, rad_from_deg(60));
  EXPECT_TRUE(Eigen::AlignedBox3d(Vec3(-3, -2, 0), Vec3(3, 2, 3)).contains(camera.eye_world_m))
      << camera.eye_world_m.transpose();
  const Vec3 lit_m(2.999, 0, 1.15);
  EXPECT_TRUE(pixel_of(camera, lit_m).has_value()) << camera.eye_world_m.transpose();
  EXPECT_FALSE(rays.occluded(lit_m, -Vec3::UnitX(), camera.eye_world_m));
  EXPECT_GT((camera.eye_world_m - lit_m).norm(), 1.5) << "not a view of a wall's grain";
}

TEST(AutomaticCamera, IgnoresAKilometreOfGround) {
  const LitRoom room = room_with(std::string(kSpotOnTheWall) +
                                 "[[scene.object]]\nname = \"ground\"\nbox_m = [1000, 1000, 0.1]\n"
                                 "position_m = [0, 0, -0.3]\n");
  const Camera camera = automatic_camera(RayScene(room.scene), room.rig, {}, 320, 200, rad_from_deg(60));
  EXPECT_TRUE(Eigen::AlignedBox3d(Vec3(-3, -2, 0), Vec3(3, 2, 3)).contains(camera.eye_world_m))
      << camera.eye_world_m.transpose();
}

TEST(AutomaticCamera, OfARoomWithoutLampsStandsInIt) {
  const LitRoom room = room_with("");
  const Camera camera = automatic_camera(RayScene(room.scene), room.rig, {}, 320, 200, rad_from_deg(60));
  EXPECT_TRUE(Eigen::AlignedBox3d(Vec3(-3, -2, 0), Vec3(3, 2, 3)).contains(camera.eye_world_m))
      << camera.eye_world_m.transpose();
}

/// Why it is dark, as seen by the automatic camera of `seen`, or of the room itself.
std::string dark_words(const LitRoom& room, double level, const LitRoom* seen = nullptr) {
  const RayScene rays(room.scene);
  const auto emitters = emitters_of(room.rig);
  const std::vector<double> levels(emitters.size(), level);
  const LitRoom& view = seen ? *seen : room;
  const Camera camera = automatic_camera(RayScene(view.scene), view.rig, {}, 32, 20, rad_from_deg(60));
  PictureOptions how;
  how.max_passes = 1;
  const auto picture = render_picture(rays, emitters, levels, camera, how);
  EXPECT_TRUE(picture.has_value());
  return why_dark(*picture, rays, room.rig, emitters, levels, "in p.json");
}

TEST(DarkPictures, AreExplained) {
  EXPECT_EQ(dark_words(room_with(kSpotOnTheWall), 1), "");
  EXPECT_EQ(dark_words(room_with(kSpotOnTheWall), 0),
            "the picture is dark: no lamp gives light, all 1 are at level 0 in p.json");
  EXPECT_EQ(dark_words(room_with(""), 1), "the picture is dark: the rig has no fixture and no daylight");
  const std::string hood = "[[scene.object]]\nname = \"hood\"\nbox_m = [0.06, 0.06, 0.06]\nposition_m = [0, 0, 2.77]\n";
  const LitRoom open = room_with(kSpotOnTheWall);
  const std::string blocked = dark_words(room_with(kSpotOnTheWall + hood), 1, &open);
  EXPECT_NE(blocked.find("One lamp is on in p.json, 1e+03 lm together: lamp is blocked: its light ends within"),
            std::string::npos)
      << blocked;
  std::string outside = kSpotOnTheWall;
  outside.replace(outside.find("[0, 0, 2.8]"), 11, "[0, 0, 9.0]");
  outside.replace(outside.find("[2.9, 0, 1.2]"), 13, "[2.9, 0,19.0]");
  const std::string past = dark_words(room_with(outside), 1);
  EXPECT_NE(past.find("lamp shines past everything"), std::string::npos) << past;
}

/// The pixels of a PNG's bytes, sRGB 0 … 1.
struct Drawn {
  int width_px = 0, height_px = 0;
  std::vector<Vec3> rgb;
  [[nodiscard]] const Vec3& at(int x, int y) const { return rgb[static_cast<std::size_t>(y * width_px + x)]; }
};

Drawn drawn_from(const std::string& png) {
  struct Source {
    const std::string* png;
    std::size_t at = 0;
  } source{&png};
  const auto read = [](void* from, unsigned char* data, unsigned int size) {
    auto& rest = *static_cast<Source*>(from);
    if (size > rest.png->size() - rest.at) return CAIRO_STATUS_READ_ERROR;
    std::memcpy(data, rest.png->data() + rest.at, size);
    rest.at += size;
    return CAIRO_STATUS_SUCCESS;
  };
  const PngSurface surface(cairo_image_surface_create_from_png_stream(read, &source), &cairo_surface_destroy);
  Drawn drawn{cairo_image_surface_get_width(surface.get()), cairo_image_surface_get_height(surface.get()), {}};
  const unsigned char* bytes = cairo_image_surface_get_data(surface.get());
  for (int y = 0; y < drawn.height_px; ++y)
    for (int x = 0; x < drawn.width_px; ++x) {
      std::uint32_t pixel = 0;
      std::memcpy(&pixel, bytes + y * cairo_image_surface_get_stride(surface.get()) + 4 * x, 4);
      drawn.rgb.emplace_back(Vec3(pixel >> 16 & 255, pixel >> 8 & 255, pixel & 255) / 255);
    }
  return drawn;
}

// A wall whose light grows tenfold from left to right. Who sees no colours sees it grow too, and lines of equal light.
TEST(FalseColour, IsOrderedByBrightnessAndBlackWhereNothingIsKnown) {
  Picture picture;
  picture.width_px = 200;
  picture.height_px = 120;
  for (int y = 0; y < picture.height_px; ++y)
    for (int x = 0; x < picture.width_px; ++x)
      picture.illuminance_lx.push_back(y < 20 ? -1.0f : static_cast<float>(10 * std::pow(10, x / 199.0)));
  const Drawn drawn = drawn_from(false_colour_png(picture, "", {"± %", 1, 100}));
  ASSERT_GT(drawn.width_px, picture.width_px + 60) << "a legend";
  ASSERT_EQ(drawn.height_px, picture.height_px);
  double before = 0;
  int lines = 0;
  for (int x = 0; x < picture.width_px; ++x) {
    EXPECT_LT(drawn.at(x, 5).norm(), 1e-9);
    const Vec3& colour = drawn.at(x, 110);  // below the lines' labels
    const Vec3 expected = viridis(x / 199.0);
    if ((colour - expected).norm() > 0.05) {
      ++lines;
      EXPECT_GT(luminance_of_rgb(colour), luminance_of_rgb(expected)) << "a line is white";
      continue;
    }
    EXPECT_GE(luminance_of_rgb(colour), before - 0.005) << x;
    before = luminance_of_rgb(colour);
  }
  EXPECT_GE(lines, 2) << "at 20 and 50";
  EXPECT_LE(lines, 6);
  EXPECT_GT(before, 0.7);
}

}  // namespace
}  // namespace luxrig
