#include "tools/luxrigd/light_of_looks.h"

#include <algorithm>

#include "core/tasks/rig_transport.h"
#include "tools/luxrigd/scheduling.h"

namespace luxrig {
namespace {

/// The look in force, and the one before it: a plan that turns back costs nothing.
constexpr std::size_t kMaxKnown = 2;

std::size_t same_aims(const std::vector<Joints>& a, const std::vector<Joints>& b) {
  std::size_t same = 0;
  for (std::size_t f = 0; f < a.size(); ++f) same += same_aim(a[f], b[f]) ? 1 : 0;
  return same;
}

}  // namespace

std::optional<KeptLight> LightOfLooks::read_saved(const Session& session) {
  if (!folder_) return std::nullopt;
  const std::uint64_t key = light_key(session.rig, session.scene, compute_);
  auto light = kept_light(*folder_, key, session.rig);
  if (!light) return std::nullopt;
  add_untraced(session, light->model);
  auto known = put({key, *light, std::nullopt});
  const std::lock_guard lock(mutex_);
  saved_ = std::move(known);
  return light;
}

void LightOfLooks::know(const Session& session, const std::vector<Joints>& joints, TransportMatrix transport) {
  put(light_key(session.rig, session.scene, compute_), session, joints, std::move(transport));
}

Result<LightModel> LightOfLooks::model(const Session& session, const std::vector<Joints>& joints) {
  const std::uint64_t key = light_key(session.rig, session.scene, compute_);
  std::shared_ptr<const Known> known = nearest(key, joints, false);
  if (!known || same_aims(known->light.joints, joints) < joints.size()) {
    known = nearest(key, joints, true);
    auto transport = in_background([&] {
      if (!known) return compute_transport(session, compute_, {{}, joints});
      const KeptTransport before{known->light.joints, *known->transport};
      return compute_transport(session, compute_, {{}, joints}, nullptr, &before);
    });
    if (!transport) return tl::unexpected(std::move(transport.error()));
    known = put(key, session, joints, std::move(*transport));
  }
  save(known);
  return known->light.model;
}

void LightOfLooks::save(const std::shared_ptr<const Known>& known) {
  if (!folder_) return;
  const std::lock_guard lock(mutex_);
  if (saved_ == known) return;
  keep_light(*folder_, known->light, known->key);
  saved_ = known;
}

std::shared_ptr<const LightOfLooks::Known> LightOfLooks::put(Known known) {
  auto last = std::make_shared<const Known>(std::move(known));
  const std::lock_guard lock(mutex_);
  if (known_.size() == kMaxKnown) known_.erase(known_.begin());
  known_.push_back(last);
  return last;
}

std::shared_ptr<const LightOfLooks::Known> LightOfLooks::put(std::uint64_t key, const Session& session,
                                                             const std::vector<Joints>& joints,
                                                             TransportMatrix transport) {
  LightModel model = light_model(session, transport);
  return put({key, {joints, std::move(model)}, std::move(transport)});
}

std::shared_ptr<const LightOfLooks::Known> LightOfLooks::nearest(std::uint64_t key, const std::vector<Joints>& joints,
                                                                 bool with_transport) const {
  const std::lock_guard lock(mutex_);
  std::shared_ptr<const Known> best;
  std::size_t max_same = 0;
  for (const auto& known : known_) {
    if (known->key != key || known->light.joints.size() != joints.size()) continue;
    if (with_transport && !known->transport) continue;
    const std::size_t same = same_aims(known->light.joints, joints);
    if (best && same < max_same) continue;
    best = known;
    max_same = same;
  }
  return best;
}

}  // namespace luxrig
