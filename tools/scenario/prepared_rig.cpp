#include "tools/scenario/prepared_rig.h"

#include "core/tasks/solve_tasks.h"
#include "tools/luxrig/open_session.h"

namespace luxrig::scenario {

Checked<PreparedRig> prepare(const std::filesystem::path& path, const PrepareOptions& options) {
  auto opened = open_stated_session(path);
  if (!opened) return tl::unexpected(std::move(opened.error()));
  const auto session = std::make_shared<const Session>(std::move(*opened));
  const Rig& rig = session->rig;
  const auto problem = [&](std::string what, std::string mend) {
    return tl::unexpected(std::vector<Problem>{{rig.file.string(), 0, 0, std::move(what), std::move(mend)}});
  };
  if (rig.fixtures.empty())
    return problem("nothing hangs in this rig, so there is no show to test", "add a [[fixture]]");
  const auto transport = compute_transport(*session, options.compute);
  if (!transport) return problem(transport.error().detail, "mend the rig file");
  auto solved = solve_what_hangs(*session, *transport, options.compute);
  if (!solved) return problem(solved.error().detail, "mend the rig file");
  auto worlds = sim::WorldMaker::make(rig, options.max_truth_error, options.compute.watch);
  if (!worlds) return problem(worlds.error().detail, "mend the rig file");
  KeptLight light{solved->look.joints, light_model(*session, solved->transport)};
  ComputeOptions in_a_show = options.compute;
  in_a_show.watch = {};
  in_a_show.threads = 1;  // each show is one process of several
  auto looks = std::make_shared<LightOfLooks>(in_a_show);
  looks->know(*session, solved->look.joints, std::move(solved->transport));
  return PreparedRig{session,   std::move(solved->plan), std::move(light),
                     in_a_show, std::move(looks),        std::move(*worlds)};
}

Result<std::unique_ptr<sim::World>> PreparedRig::world_of(const Scenario& scenario, std::uint64_t seed) const {
  sim::Deviations deviations = scenario.deviations;
  deviations.seed = seed;
  return worlds.world(deviations);
}

}  // namespace luxrig::scenario
