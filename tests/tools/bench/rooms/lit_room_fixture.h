#pragma once
/// Shared by the tests of lit_room.

#include <gtest/gtest.h>

#include "tools/bench/rooms/lit_room.h"

namespace luxrig::lit_room_fixture {

struct Expected {
  const char* name;
  LitRoom (*make)(std::uint64_t);
  std::size_t fewest_triangles, max_triangles, emitters, receivers;
  bool closed;
};

inline constexpr Expected kRooms[] = {
    {"box", [](std::uint64_t seed) { return make_box_room(seed); }, 100, 160, 2, 60, true},
    {"flat", [](std::uint64_t seed) { return make_eight_room_flat(seed); }, 570, 640, 10, 300, true},
    {"gallery", [](std::uint64_t seed) { return make_gallery_hall(seed); }, 37'000, 39'000, 12, 300, true},
    {"atrium", [](std::uint64_t seed) { return make_atrium(seed); }, 8'000, 11'000, 46, 300, false},
    {"office", [](std::uint64_t seed) { return make_open_plan_office(seed); }, 3'000, 3'200, 9, 300, true},
    {"sewers", [](std::uint64_t seed) { return make_sewers(seed); }, 20'000, 28'000, 11, 300, true},
    {"cloister", [](std::uint64_t seed) { return make_cloister(seed); }, 20'000, 26'000, 16, 300, false},
    {"museum", [](std::uint64_t seed) { return make_museum(seed); }, 50'000, 100'000, 18, 360, true},
    {"studio", [](std::uint64_t seed) { return make_studio(seed); }, 110'000, 170'000, 2, 300, true},
    {"colonnades", [](std::uint64_t seed) { return make_colonnades(seed); }, 45'000, 65'000, 22, 300, false},
};

inline void PrintTo(const Expected& expected, std::ostream* out) { *out << expected.name; }

class LitRooms : public testing::TestWithParam<Expected> {};

}  // namespace luxrig::lit_room_fixture
