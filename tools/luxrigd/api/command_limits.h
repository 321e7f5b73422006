#pragma once
/// Bounds of what a client may send. The schemas state them and the routes check them.

#include <cstddef>

namespace luxrig {

inline constexpr double kIdentifyAtMost_s = 60;  ///< and a head aimed by hand
inline constexpr double kLongestByHand_s = 366.0 * 86400;
inline constexpr double kShortestFade_s = 0.1, kLongestFade_s = 600;
inline constexpr double kLongestAsked_s = 600;
inline constexpr double kFarthest_m = 1e5;  ///< of a place from the world's zero, along each axis
inline constexpr const char* kQuestionId = "^[0-9A-Za-z_-]{1,40}$";  ///< is_question_id()
inline constexpr std::size_t kMaxPlanBytes = 16u << 20;
inline constexpr std::size_t kMaxPaintingBytes = 4u << 20;
inline constexpr std::size_t kMaxShortBytes = 1024;  ///< of a body with a few keys

}  // namespace luxrig
