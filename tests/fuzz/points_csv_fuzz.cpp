// Any bytes as a points file: never a crash; sound points, or problems that can be shown to a person.
#include <cmath>
#include <cstdint>

#include "core/check.h"
#include "core/rig/points_csv.h"
#include "core/text/plain_text.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const auto table = luxrig::parse_points_csv(text, "fuzz.csv", 100);
  LUXRIG_CHECK(table.rows.size() <= 100, "{} rows", table.rows.size());
  for (const auto& row : table.rows) {
    LUXRIG_CHECK(!row.point.name.empty() && luxrig::is_plain_text(row.point.name), "{}", row.point.name);
    LUXRIG_CHECK(row.point.position_world_m.allFinite(), "{}", row.point.name);
    LUXRIG_CHECK(std::abs(row.point.normal_world.norm() - 1) < 1e-9, "{}", row.point.name);
  }
  for (const luxrig::Problem& problem : table.problems) {
    LUXRIG_CHECK(!problem.mend.empty() && luxrig::is_plain_text(problem.text()), "{}", problem.text());
  }
  return 0;
}
