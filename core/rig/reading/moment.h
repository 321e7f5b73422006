#pragma once
/// A moment as written by a person: "2026-06-21T12:00:00+02:00".

#include <string>
#include <string_view>
#include <tl/expected.hpp>

#include "core/photometry/sky/sun_position.h"

namespace luxrig {

/// Reads a date, `T` or a blank, hours and minutes (whole seconds are optional), and the offset from UTC: `Z`, or + or
/// - hh:mm. The offset is required: without it, a moment could be an hour or a continent off. Years 1900 to 2100, as
/// for sun_position(). The error is a text for `what` of a Problem.
/// Source: RFC 3339, without fractions of a second and without leap seconds.
[[nodiscard]] tl::expected<UtcTime, std::string> utc_time(std::string_view text);

/// 1…366
[[nodiscard]] int day_of_year(const UtcTime& time);

}  // namespace luxrig
