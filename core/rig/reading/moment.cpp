#include "core/rig/reading/moment.h"

#include <fmt/format.h>

#include <charconv>
#include <optional>

namespace luxrig {
namespace {

constexpr int kFirstYear = 1900, kLastYear = 2100;

bool leap(int year) { return (year % 4 == 0 && year % 100 != 0) || year % 400 == 0; }

int days_of_month(int year, int month) {
  constexpr int kDays[] = {31, 28, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31};
  return month == 2 && leap(year) ? 29 : kDays[month - 1];
}

/// Removes one of `marks`, then `digits` digits, from the start of the text.
std::optional<int> take(std::string_view& text, std::string_view marks, std::size_t digits) {
  if (!marks.empty()) {
    if (text.empty() || marks.find(text.front()) == std::string_view::npos) return std::nullopt;
    text.remove_prefix(1);
  }
  if (text.size() < digits) return std::nullopt;
  const std::string_view number = text.substr(0, digits);
  if (number.find_first_not_of("0123456789") != std::string_view::npos) return std::nullopt;
  int value = 0;
  std::from_chars(number.data(), number.data() + digits, value);
  text.remove_prefix(digits);
  return value;
}

}  // namespace

tl::expected<UtcTime, std::string> utc_time(std::string_view text) {
  const auto refuse = [](std::string what) { return tl::unexpected(std::move(what)); };
  const auto year = take(text, "", 4), month = take(text, "-", 2), day = take(text, "-", 2);
  const auto hour = take(text, "Tt ", 2), minute = take(text, ":", 2);
  if (!year || !month || !day || !hour || !minute) return refuse("is not a date and time");
  int second = 0;
  if (text.starts_with(':')) {
    const auto given = take(text, ":", 2);
    if (!given) return refuse("is not a date and time");
    second = *given;
  }
  if (*year < kFirstYear || *year > kLastYear) return refuse(fmt::format("has the year {}", *year));
  if (*month < 1 || *month > 12) return refuse(fmt::format("has the month {}", *month));
  if (*day < 1 || *day > days_of_month(*year, *month))
    return refuse(fmt::format("has the day {}, which {}-{:02} has not", *day, *year, *month));
  if (*hour > 23 || *minute > 59 || second > 59)
    return refuse(fmt::format("has the time {:02}:{:02}:{:02}", *hour, *minute, second));
  double offset_h = 0;
  if (text == "Z" || text == "z") {
    text = {};
  } else if (text.empty()) {
    return refuse("does not say how far its clock is from UTC");
  } else {
    const double sign = text.front() == '-' ? -1 : 1;
    const auto hours = take(text, "+-", 2), minutes = take(text, ":", 2);
    if (!hours || !minutes) return refuse("ends in something that is no offset from UTC");
    if (*hours > 23 || *minutes > 59) return refuse(fmt::format("has an offset of {:02}:{:02}", *hours, *minutes));
    offset_h = sign * (*hours + *minutes / 60.0);
  }
  if (!text.empty()) return refuse("goes on after its offset from UTC");
  return UtcTime{*year, *month, *day, *hour + *minute / 60.0 + second / 3600.0 - offset_h};
}

int day_of_year(const UtcTime& time) {
  int days = time.day;
  for (int month = 1; month < time.month; ++month) days += days_of_month(time.year, month);
  return days;
}

}  // namespace luxrig
