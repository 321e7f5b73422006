/// Misuses that must not compile. tests/misuse/check compiles this file with MISUSE = 0, which must succeed, and then
/// once for each number, which must fail. The comment behind a number is the expected compiler message.

#include "core/rig/rig_file.h"
#include "core/scene/ray_scene.h"
#include "core/show/show_controller.h"
#include "core/tasks/stage.h"
#include "core/transport/evaluator.h"
#include "drivers/driver.h"

namespace luxrig {

void misuse(ShowController& show, Driver& driver, const Stage& stage, const Scene& scene, Time now) {
#if MISUSE == 0
  show.step(now + from_seconds(0.5));
  const auto rig = load_rig("rig.toml");
  if (!rig || !driver.activate(now)) return;
  const RayScene rays(scene);
  const auto evaluator = make_path_evaluator(rays);
  stage.say(evaluator ? rig->name : "");
#elif MISUSE == 1   // conversion from 'double' to non-scalar type 'const luxrig::Duration'
  const Duration half_a_second = 0.5;
#elif MISUSE == 2   // cannot convert 'double' to 'luxrig::Time'
  show.step(0.5);
#elif MISUSE == 3   // no match for 'operator+'
  show.step(now + now);
#elif MISUSE == 4   // ignoring return value
  load_rig("rig.toml");
#elif MISUSE == 5   // conversion from 'luxrig::Checked<luxrig::Rig>'
  const Rig rig = load_rig("rig.toml");
#elif MISUSE == 6   // could not convert
  const auto refused = []() -> Checked<double> { return refusal("a fault is not a problem in a file"); };
#elif MISUSE == 7   // use of deleted function 'luxrig::Stage::Stage(const luxrig::Stage&)'
  const Stage same = stage;
#elif MISUSE == 8   // use of deleted function
  const ShowController same = show;
#elif MISUSE == 9   // invalid initialization of reference of type 'const luxrig::RayScene&'
  const auto evaluator = make_path_evaluator(scene);
#elif MISUSE == 10  // cannot convert 'int' to 'luxrig::Cause'
  const Fault fault{2, "dimmer", "no answer", now};
#elif MISUSE == 11  // cannot allocate an object of abstract type
  const Driver same = driver;
#endif
}

}  // namespace luxrig
