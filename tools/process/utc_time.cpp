#include "tools/process/utc_time.h"

#include <fmt/chrono.h>

#include <ctime>
#include <iomanip>
#include <limits>
#include <sstream>

namespace luxrig {

std::string utc_text(std::int64_t unix_s) {
  return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(static_cast<std::time_t>(unix_s)));
}

std::string utc_now() { return utc_text(std::time(nullptr)); }

double hours_since(const std::string& instant, std::int64_t now_unix_s) {
  std::tm parts{};
  std::istringstream text(instant);
  text >> std::get_time(&parts, "%Y-%m-%dT%H:%M:%SZ");
  const std::time_t then = timegm(&parts);
  // Written again, 31 February would be a day of March.
  if (text.fail() || utc_text(then) != instant || then > now_unix_s) return std::numeric_limits<double>::infinity();
  return static_cast<double>(now_unix_s - then) / 3600;
}

double hours_since(const std::string& instant) { return hours_since(instant, std::time(nullptr)); }

}  // namespace luxrig
