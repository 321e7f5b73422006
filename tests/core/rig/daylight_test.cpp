// [daylight] of the rig file: position of the sun, brightness of sun and sky.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "core/rig/reading/moment.h"
#include "core/rig/rig_file.h"

namespace luxrig {
namespace {

Checked<Rig> rig_with(const std::string& daylight) {
  return parse_rig("[rig]\nname = \"lit\"\n[daylight]\n" + daylight, "lit.toml", ".");
}

Daylight daylight_of(const std::string& text) {
  const Checked<Rig> rig = rig_with(text);
  EXPECT_TRUE(rig) << rig.error()[0].text();
  return rig && rig->daylight ? *rig->daylight : Daylight{};
}

using SkyKind = Daylight::SkyKind;

TEST(DaylightOfARig, IsAbsentWithoutItsTable) {
  const Checked<Rig> rig = parse_rig("[rig]\nname = \"dark\"\n", "dark.toml", ".");
  ASSERT_TRUE(rig);
  EXPECT_FALSE(rig->daylight);
}

TEST(DaylightOfARig, AcceptsEverySky) {
  const char* sun = "\nhorizontal_lx = 9000\nsun_azimuth_deg = 90\nsun_elevation_deg = 30\n";
  EXPECT_EQ(daylight_of(std::string("sky = \"uniform\"") + sun).sky, SkyKind::uniform);
  EXPECT_EQ(daylight_of(std::string("sky = \"overcast\"") + sun).sky, SkyKind::overcast);
  EXPECT_EQ(daylight_of(std::string("sky = \"clear\"") + sun).sky, SkyKind::clear);
  for (int type = 1; type <= 15; ++type) {
    const Daylight general = daylight_of(fmt::format("sky = \"general\"\nsky_type = {}{}", type, sun));
    EXPECT_EQ(general.sky, SkyKind::general);
    EXPECT_EQ(general.general_type, type);
    EXPECT_EQ(general.horizontal_lx, 9000);
    EXPECT_EQ(general.sun_normal_lx > 0, type > 5) << "an overcast sky hides the sun";
  }
}

TEST(DaylightOfARig, SkiesSymmetricAboutTheZenithNeedNoSun) {
  for (const int type : {1, 3, 5})
    EXPECT_TRUE(rig_with(fmt::format("sky = \"general\"\nsky_type = {}\nhorizontal_lx = 9000\n", type))) << type;
  for (const int type : {2, 4, 6, 12})
    EXPECT_FALSE(rig_with(fmt::format("sky = \"general\"\nsky_type = {}\nhorizontal_lx = 9000\n", type))) << type;
}

TEST(DaylightOfARig, NorthRotatesTheSun) {
  const auto towards = [](double azimuth_deg, double north_deg) {
    return daylight_of(fmt::format("sky = \"clear\"\nsun_azimuth_deg = {}\nsun_elevation_deg = 60\nnorth_deg = {}\n",
                                   azimuth_deg, north_deg))
        .towards_sun_world;
  };
  const double h = 0.5, up = std::sqrt(0.75);  // cos and sin of 60°
  EXPECT_LT((towards(0, 0) - Vec3(0, h, up)).norm(), 1e-12);
  EXPECT_LT((towards(90, 0) - Vec3(h, 0, up)).norm(), 1e-12) << "east is to the right of north";
  EXPECT_LT((towards(180, 0) - Vec3(0, -h, up)).norm(), 1e-12);
  EXPECT_LT((towards(0, -90) - Vec3(h, 0, up)).norm(), 1e-12) << "north is +x";
  EXPECT_LT((towards(90, -90) - Vec3(0, -h, up)).norm(), 1e-12);
}

TEST(DaylightOfARig, PlaceAndTimeGiveTheSunsPosition) {
  // Reda and Andreas, NREL/TP-560-34302, appendix A.5: azimuth 194.34024°, elevation without refraction 39.872046°.
  const Vec3 sun = daylight_of(
                       "sky = \"clear\"\nlatitude_deg = 39.742476\nlongitude_deg = -105.1786\n"
                       "time = \"2003-10-17T12:30:30-07:00\"\n")
                       .towards_sun_world;
  EXPECT_NEAR(deg_from_rad(std::asin(sun.z())), 39.872046, 0.01);
  EXPECT_NEAR(deg_from_rad(std::atan2(sun.x(), sun.y())), 194.34024 - 360, 0.01);
}

TEST(DaylightOfARig, UnmeasuredSkiesUseTheMeanForTheSunsHeight) {
  // IES 1984 at 30°: clear 0.8 + 15.5 √½, overcast 0.3 + 21/2, partly cloudy 0.3 + 45/2 klx.
  const char* sun = "\nsun_azimuth_deg = 0\nsun_elevation_deg = 30\n";
  const Daylight clear = daylight_of(std::string("sky = \"clear\"") + sun);
  EXPECT_NEAR(clear.horizontal_lx, 800 + 15'500 * std::sqrt(0.5), 1e-6);
  EXPECT_NEAR(clear.sun_normal_lx, 127'500 * std::exp(-0.42), 1e-6);
  const Daylight overcast = daylight_of(std::string("sky = \"overcast\"") + sun);
  EXPECT_NEAR(overcast.horizontal_lx, 10'800, 1e-6);
  EXPECT_EQ(overcast.sun_normal_lx, 0);
  const Daylight partly = daylight_of(std::string("sky = \"general\"\nsky_type = 8") + sun);
  EXPECT_NEAR(partly.horizontal_lx, 22'800, 1e-6);
  EXPECT_NEAR(partly.sun_normal_lx, 127'500 * std::exp(-1.6), 1e-6);
  // Measured values take precedence.
  const Daylight given = daylight_of(std::string("sky = \"clear\"\nhorizontal_lx = 7\nsun_normal_lx = 9") + sun);
  EXPECT_EQ(given.horizontal_lx, 7);
  EXPECT_EQ(given.sun_normal_lx, 9);
  EXPECT_EQ(daylight_of(std::string("sky = \"clear\"\nsun = false") + sun).sun_normal_lx, 0);
}

TEST(DaylightOfARig, IsAbsentAtNightWithANote) {
  const char* night = "latitude_deg = 52.5\nlongitude_deg = 13.4\ntime = \"2026-06-21T00:00:00+02:00\"\n";
  const Checked<Rig> dark = rig_with(std::string("sky = \"clear\"\n") + night);
  ASSERT_TRUE(dark);
  EXPECT_EQ(dark->daylight->sky, SkyKind::none);
  EXPECT_EQ(dark->daylight->sun_normal_lx, 0);
  ASSERT_EQ(dark->notes.size(), 1u);
  EXPECT_NE(dark->notes[0].what.find("below the horizon"), std::string::npos);
  const Checked<Rig> dusk = rig_with(std::string("sky = \"clear\"\nhorizontal_lx = 30\nsun_normal_lx = 5\n") + night);
  ASSERT_TRUE(dusk);
  EXPECT_EQ(dusk->daylight->sky, SkyKind::clear);
  EXPECT_EQ(dusk->daylight->sun_normal_lx, 0);
}

TEST(Moment, IsReadWithItsOffset) {
  const auto time = utc_time("2026-06-21T12:30:45+02:00");
  ASSERT_TRUE(time) << time.error();
  EXPECT_EQ(time->year, 2026);
  EXPECT_EQ(time->month, 6);
  EXPECT_EQ(time->day, 21);
  EXPECT_NEAR(time->hours, 10 + 30 / 60.0 + 45 / 3600.0, 1e-12);
  EXPECT_NEAR(utc_time("2026-06-21 12:30Z")->hours, 12.5, 1e-12);
  EXPECT_NEAR(utc_time("2026-06-21T01:00-09:30")->hours, 10.5, 1e-12);
  EXPECT_NEAR(utc_time("2026-01-01T00:15:00+05:45")->hours, -5.5, 1e-12);  // the evening before; sun_position takes it
  EXPECT_TRUE(utc_time("2024-02-29T00:00Z"));
  EXPECT_TRUE(utc_time("2000-02-29T00:00Z"));
}

TEST(Moment, RefusesInvalidTimes) {
  for (const char* text : {"",
                           "now",
                           "2026",
                           "2026-06-21",
                           "2026-06-21T12:00:00",
                           "2026-06-21T12Z",
                           "2026-6-21T12:00Z",
                           "2026-13-01T12:00Z",
                           "2026-00-01T12:00Z",
                           "2026-04-31T12:00Z",
                           "2023-02-29T12:00Z",
                           "1900-02-29T12:00Z",
                           "2026-06-21T24:00Z",
                           "2026-06-21T12:60Z",
                           "2026-06-21T12:00:60Z",
                           "2026-06-21T12:00:Z",
                           "2026-06-21T12:00+2",
                           "2026-06-21T12:00+02",
                           "2026-06-21T12:00+02:60",
                           "2026-06-21T12:00Zulu",
                           "2026-06-21T12:00+02:00 ",
                           "1899-06-21T12:00Z",
                           "2101-06-21T12:00Z",
                           "+026-06-21T12:00Z",
                           "2026-06-21T-1:00Z",
                           "2026-06-21T12:00:00.5Z"})
    EXPECT_FALSE(utc_time(text)) << text;
}

TEST(Moment, GivesItsDayOfTheYear) {
  EXPECT_EQ(day_of_year({2026, 1, 1, 0}), 1);
  EXPECT_EQ(day_of_year({2026, 12, 31, 0}), 365);
  EXPECT_EQ(day_of_year({2024, 12, 31, 0}), 366);
  EXPECT_EQ(day_of_year({2024, 3, 1, 0}), 61);
}

}  // namespace
}  // namespace luxrig
