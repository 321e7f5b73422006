#pragma once
/// A moment as a person writes it: "2026-06-21T12:00:00+02:00".

#include <string>
#include <string_view>
#include <tl/expected.hpp>

#include "core/photometry/sun_position.h"

namespace luxrig {

/// Date, `T` or a blank, hours and minutes (seconds if wanted, whole), and the offset from UTC: `Z`, or + or - hh:mm.
/// The offset has to be there: a moment without one would be an hour or a continent off.
/// Years 1900 to 2100, for which sun_position() is made. The error says what is wrong, for a Problem's `what`.
/// source   RFC 3339, without fractions of a second and without leap seconds
[[nodiscard]] tl::expected<UtcTime, std::string> utc_time(std::string_view text);

/// 1…366
[[nodiscard]] int day_of_year(const UtcTime& time);

}  // namespace luxrig
