#include "core/transport/direct_light.h"

#include <atomic>

#include "core/parallel.h"
#include "core/transport/progress.h"

namespace luxrig {

const RayScene* obstacles_in(const RayScene& scene) { return scene.bounds_world_m().isEmpty() ? nullptr : &scene; }

Result<DirectLight> direct_light(const RayScene& scene, std::span<const Receiver> receivers, const Lamps& lamps,
                                 std::size_t emitters, int threads, const Watch& watch, double progress_end) {
  const RayScene* obstacles = obstacles_in(scene);
  DirectLight direct;
  direct.lux_per_level =
      Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(receivers.size()), static_cast<Eigen::Index>(emitters));
  std::vector<std::uint64_t> rays(receivers.size(), 0);
  CallingThreadProgress progress(watch, 0, progress_end, receivers.size());
  parallel_for(receivers.size(), threads, [&](std::size_t r) {
    if (watch.stop.stop_requested()) return;
    rays[r] = lamps.light(obstacles, receivers[r].position_world_m, receivers[r].normal_world,
                          [&](std::size_t e, double lux) {
                            direct.lux_per_level(static_cast<Eigen::Index>(r), static_cast<Eigen::Index>(e)) = lux;
                          });
    progress.one_done();
  });
  if (watch.stop.stop_requested())
    return tl::unexpected(Fault{Cause::cancelled, "", "stopped while computing direct light", {}});
  for (const std::uint64_t n : rays) direct.rays += n;
  progress.report_end();
  return direct;
}

}  // namespace luxrig
