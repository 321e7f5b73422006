// Any bytes as the daemon's status: refused with a reason, or a status of the rig.
#include <cmath>
#include <cstdint>
#include <string_view>

#include "core/check.h"
#include "core/text/plain_text.h"
#include "tests/tools/scenario/small_rig.h"
#include "tools/scenario/status_of_json.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace luxrig;
  static const Rig rig = scenario::small_rig();
  const auto read = scenario::status_of_json({reinterpret_cast<const char*>(data), size}, rig);
  if (!read) {
    LUXRIG_CHECK(!read.error().detail.empty(), "refused without a reason");
    return 0;
  }
  const ShowStatus& show = read->show;
  LUXRIG_CHECK(show.points.size() == rig.points.size() && show.fixtures.size() == rig.fixtures.size(), "another rig");
  LUXRIG_CHECK(read->sent.size() == rig.buses.size() && read->sends.size() == rig.buses.size(), "other buses");
  LUXRIG_CHECK(show.goals.met >= 0 && show.goals.missed >= 0 && show.goals.unknown >= 0, "fewer goals than none");
  for (const PointStatus& point : show.points)
    LUXRIG_CHECK(std::isfinite(point.goal_lx.value_or(0)), "goal {}", *point.goal_lx);
  for (const FixtureStatus& fixture : show.fixtures)
    LUXRIG_CHECK(std::isfinite(fixture.level), "level {}", fixture.level);
  for (const Alarm& alarm : show.alarms)
    LUXRIG_CHECK(is_plain_text(alarm.device) && is_plain_text(alarm.text), "alarm {}", alarm.text);
  for (const ByHand& held : show.by_hand)
    LUXRIG_CHECK(held.index < (held.what == ByHand::What::level ? rig.fixtures.size() : rig.points.size()) &&
                     std::isfinite(held.value),
                 "held {} {}", held.index, held.value);
  return 0;
}
