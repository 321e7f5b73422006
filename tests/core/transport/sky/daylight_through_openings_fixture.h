#pragma once
/// Shared by the tests of daylight_through_openings.

#include <gtest/gtest.h>

#include "tests/core/transport/sky/room_with_windows.h"

namespace luxrig::daylight_through_openings_fixture {

inline std::vector<Emitter> under(const Sky& sky) {
  std::vector<Emitter> emitters(1);
  emitters[0].sky = sky;
  return emitters;
}

inline TransportMatrix evaluated(const Evaluator& evaluator, const std::vector<Receiver>& receivers,
                                 const std::vector<Emitter>& emitters, const EvaluateOptions& options) {
  auto result = evaluator.evaluate(receivers, emitters, options);
  EXPECT_TRUE(result.has_value()) << (result ? "" : result.error().detail);
  return result ? std::move(*result) : TransportMatrix{};
}

/// A window of 4 % of its wall's area.
inline RoomWithWindows with_a_small_window() {
  RoomWithWindows room;
  room.near_window_m = {1.5, 2.3, 1.2, 1.8};
  return room;
}

inline RoomWithWindows with_windows_that_face_each_other() {
  RoomWithWindows room;
  room.near_window_m = {1.2, 2.6, 1.0, 2.2};
  room.far_window_m = {1.0, 2.9, 0.9, 2.3};
  return room;
}

}  // namespace luxrig::daylight_through_openings_fixture
