#include "core/highlight/shadow/surroundings.h"

#include <algorithm>
#include <vector>

#include "core/check.h"

namespace luxrig {

void find_blocked(const Surroundings& surroundings, const Vec3& from_world_m, std::span<const Vec3> to_world_m,
                  std::span<Blocked> blocked) {
  LUXRIG_CHECK(blocked.size() == to_world_m.size(), "{} answers for {} places", blocked.size(), to_world_m.size());
  std::fill(blocked.begin(), blocked.end(), Blocked::by_nothing);
  if (to_world_m.empty()) return;
  std::vector<std::uint8_t> stopped(to_world_m.size());
  const auto ask = [&](const RayScene* scene, Blocked by) {
    if (scene == nullptr) return;
    scene->occluded_many(from_world_m, Vec3::Zero(), to_world_m, stopped);
    for (std::size_t i = 0; i < stopped.size(); ++i)
      if (stopped[i]) blocked[i] = by;
  };
  ask(surroundings.occluders, Blocked::by_occluders);
  ask(surroundings.environment, Blocked::by_environment);
}

}  // namespace luxrig
